//! The tests that cross crates: one binary, one module per theme.

mod scene_files; // Scene files, good and bad: what loads, what it becomes, and the very words of each refusal.
