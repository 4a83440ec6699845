// A target that precompiles headers wants a source file; this one has nothing to say.
