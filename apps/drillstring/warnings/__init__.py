"""What is large compared with what, before a run: scene, bit, beam, compression, wall."""
