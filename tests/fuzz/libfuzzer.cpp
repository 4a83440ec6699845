// The same targets under libFuzzer.

#include "tests/fuzz/target.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    puckloop::fuzz::run_input({data, size});
    return 0;
}
