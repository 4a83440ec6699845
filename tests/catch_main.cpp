#define CATCH_CONFIG_RUNNER
#include <catch2/catch.hpp>

#include <cstdlib>

int main(int argc, char** argv) {
    // No test sees or fills the cache of whoever runs it; those about the cache name one of their own.
    ::setenv("PUCKLOOP_CACHE", "off", 1);
    Catch::Session session;
    // A name that no case has is an error: CTest splits names at semicolons, and such cases passed unseen.
    session.configData().warnings = Catch::WarnAbout::NoTests;
    const int wrong = session.applyCommandLine(argc, argv);
    return wrong != 0 ? wrong : session.run();
}
