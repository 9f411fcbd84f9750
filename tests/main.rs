//! The tests that cross crates: one binary, one module per theme.

mod backends; // Every backend finds the hit that brute finds, and nothing leaks.
mod behaviour; // Signals, full disks, folders that cannot be written to: the promised exit code and no half file.
mod command_line; // What a user types: exit codes, error sentences, files.
mod environment; // Environment maps: what they light, what is seen of them, and which files are refused.
mod fuzz; // Whatever bytes a file holds, it loads soundly or is refused with a line that exists.
mod hard_cases; // Inputs that broke other renderers, replayed in every arithmetic.
mod instruments; // Each instrument passes the kernel and catches its planted faults.
mod large; // Ten million triangles, in small: memory per triangle, progress, files that are only large.
mod mitsuba; // The Cornell box and scenes under environment and normal maps are the pictures that Mitsuba 3 makes.
mod model_tables; // The tables of models in the docs say what the kernel declares.
mod normal_maps; // Normal maps in scene files: which way a bump points, what light is lost, which files are refused.
mod pictures; // Threads, crops, plans, backends, scale and place never change a picture.
mod scene_files; // Scene files, good and bad: what loads, what it becomes, and the very words of each refusal.
mod structure; // The order of the crates, no import cycles, no file of two thoughts.
mod support; // Shared: where data lies, small scenes, random numbers.
