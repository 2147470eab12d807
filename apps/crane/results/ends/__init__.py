"""Why a run of a crane ended where a step found no solution."""
