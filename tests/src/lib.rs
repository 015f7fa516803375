//! Slow, obvious models of what scanseg does, for its tests.
