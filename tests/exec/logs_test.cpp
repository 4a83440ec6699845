#include "bench/logs.h"

#include "base/error.h"
#include "ends/text_input.h"

#include <catch2/catch.hpp>

#include <unistd.h>

#include <filesystem>
#include <fstream>

using namespace puckloop;

namespace {

struct Folder {
    std::string path = std::filesystem::temp_directory_path() / ("puckloop_logs_" + std::to_string(getpid()));
    Folder() { std::filesystem::remove_all(path); }
    ~Folder() { std::filesystem::remove_all(path); }
};

}  // namespace

TEST_CASE("the logs hold a header and one row for what happened") {
    const Folder folder;
    exec::Logs logs(folder.path + "/deep/er");
    logs.uart(2, cosim::kSecond + 1500 * cosim::kNanosecond, "tx", 0x0C, "");
    logs.uart(2, 2 * cosim::kSecond, "rx", -1, "overrun");
    cosim::I2cPhase phase;
    phase.kind = cosim::I2cPhaseKind::Start;
    phase.byte = 0x40;
    phase.start = cosim::kMillisecond;
    phase.clock_period = 10 * cosim::kMicrosecond;
    logs.i2c(1, phase);
    logs.pin(0, "RA6", "led0", "z");
    logs.flush();
    const std::string base = folder.path + "/deep/er/";
    CHECK(exec::read_text_file(base + "uart1.csv") == "time_s,direction,byte,error\n");
    CHECK(exec::read_text_file(base + "uart2.csv") ==
          "time_s,direction,byte,error\n1.000001500,tx,0c,\n2.000000000,rx,,overrun\n");
    CHECK(exec::read_text_file(base + "i2c.csv") == "time_s,module,event,byte,ack,clock_hz,stretch_s\n"
                                                    "0.001000000,1,start,40,0,100000,0.000000000\n");
    CHECK(exec::read_text_file(base + "pins.csv") == "time_s,pin,signal,value\n0.000000000,RA6,led0,z\n");
}

TEST_CASE("a folder that cannot be made is an input error, a full disk is a run error that names the file") {
    const Folder folder;
    std::filesystem::create_directories(folder.path);
    std::ofstream(folder.path + "/file") << "x";
    CHECK_THROWS_AS(exec::Logs(folder.path + "/file/sub"), InputError);
    exec::CsvFile full("/dev/full", "a,b");
    try {
        for (int i = 0; i < 100000; ++i)
            full.row("1,2");
        full.flush();
        FAIL("a full disk went unnoticed");
    } catch (const RunError& error) {
        CHECK(std::string(error.what()).find("/dev/full: cannot be written") == 0);
    }
}

TEST_CASE("text files: missing, a folder, whole") {
    const Folder folder;
    std::filesystem::create_directories(folder.path);
    CHECK_THROWS_AS(exec::read_text_file(folder.path), InputError);
    CHECK_THROWS_AS(exec::read_text_file(folder.path + "/none"), InputError);
    std::ofstream(folder.path + "/a") << "x\ny";
    CHECK(exec::read_text_file(folder.path + "/a") == "x\ny");
}
