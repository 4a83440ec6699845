#define CATCH_CONFIG_RUNNER
#include <catch2/catch.hpp>

#include <cstdlib>

int main(int argc, char** argv) {
    // No test sees or fills the cache of whoever runs it; those about the cache name one of their own.
    ::setenv("PUCKLOOP_CACHE", "off", 1);
    return Catch::Session().run(argc, argv);
}
