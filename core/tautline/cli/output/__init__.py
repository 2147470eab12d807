"""What a command gives out: words, tables and progress for people, JSON for programs, files."""
