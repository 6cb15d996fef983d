// The source of the target that compiles base/precompiled.h: a header is compiled for a target.
