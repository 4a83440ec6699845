// Only in sanitizer builds: options of a program that may run under the shim.

extern "C" const char* __asan_default_options();

/// No search for leaks at the end: it stops the program's threads by calls whose number depends on the
/// host, so that no two runs would end at the same simulated time. control_tests looks for leaks in the
/// same code.
extern "C" const char* __asan_default_options() {
    return "detect_leaks=0";
}
