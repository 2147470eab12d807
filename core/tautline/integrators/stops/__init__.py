"""Why a run has stopped: which part of the scene is to blame, and which element is without material."""
