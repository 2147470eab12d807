"""Results in space as files of other programs: ParaView."""
