//! Ray casting for Gonio: one trait over rays in eights, several backends
