// Only in sanitizer builds: what a program under the shim is not blamed for.

extern "C" const char* __lsan_default_suppressions();

/// The shim leaves a closed file's few bytes alone: another thread may still be inside a call on it.
extern "C" const char* __lsan_default_suppressions() {
    return "leak:puckloop::shim::open_device\n";
}
