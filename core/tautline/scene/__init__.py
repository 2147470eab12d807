"""What a person writes: YAML read into validated, frozen models; no compiled code."""
