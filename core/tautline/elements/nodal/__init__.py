"""What acts at nodes: masses, forces, springs, supports that rope slides through, jets, open ends."""
