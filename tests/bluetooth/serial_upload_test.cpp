// `puckloop upload` through a terminal whose far end is a boot loader behind a line that holds bytes back at
// random, as the air does and a busy machine: what is then in the flash.

#include "base/error.h"
#include "base/random.h"
#include "bench/upload/serial_upload.h"
#include "ends/pty_speed.h"

#include <catch2/catch.hpp>

#include <fcntl.h>
#include <poll.h>
#include <stdlib.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <filesystem>
#include <map>
#include <numeric>
#include <thread>

using namespace puckloop;
using namespace puckloop::tools;
using std::chrono::milliseconds;

namespace {

/// The robot's side: Tiny Bootloader as its image has it, without its time-outs.
class Robot {
  public:
    /// Bytes wait up to `longest_hold` ms; each `resets`-th row is broken by the reset button (0: none).
    Robot(std::uint64_t seed, std::uint64_t longest_hold, int resets)
        : random_(seed, "hold"),
          hold_(longest_hold),
          resets_(resets),
          master_(posix_openpt(O_RDWR | O_NOCTTY)) {
        REQUIRE(master_ >= 0);
        REQUIRE(grantpt(master_) == 0);
        REQUIRE(unlockpt(master_) == 0);
        char name[128];
        REQUIRE(ptsname_r(master_, name, sizeof name) == 0);
        name_ = name;
        exec::set_raw_terminal(master_, 115200);
        thread_ = std::thread([this] { work(); });
    }
    ~Robot() {
        stop_ = true;
        thread_.join();
        ::close(master_);
    }
    const std::string& name() const { return name_; }
    std::map<std::uint32_t, BootPacket> flash;  ///< rows by address; once `ended`
    std::atomic<bool> ended{false};

  private:
    void work() {
        while (!stop_) {
            pollfd wait{master_, POLLIN, 0};
            if (::poll(&wait, 1, 2) != 1) continue;
            if (hold_ > 0 && random_.below(8) == 0)
                std::this_thread::sleep_for(milliseconds(random_.below(hold_)));
            std::uint8_t block[512];
            const ssize_t got = ::read(master_, block, sizeof block);
            for (ssize_t i = 0; i < got; ++i)
                take(block[i]);
        }
    }
    void say(std::initializer_list<std::uint8_t> octets) {
        for (const std::uint8_t octet : octets)
            (void)!::write(master_, &octet, 1);
    }
    void take(std::uint8_t octet) {
        if (ended) return;
        if (!listening_) {
            if (octet != kBootHello) return;
            listening_ = true;
            packet_.clear();
            say({kBootChip, kBootOk});
            return;
        }
        packet_.push_back(octet);
        if (packet_.size() == 4 && octet == 0xff) {
            ended = true;
            return;
        }
        if (resets_ > 0 && packet_.size() == 50 && ++rows_ % resets_ == 0) {
            listening_ = false;
            return;
        }
        if (packet_.size() < 101) return;
        if (std::accumulate(packet_.begin(), packet_.end(), 0U) % 256 == 0) {
            flash[packet_[0] | packet_[1] << 8 | packet_[2] << 16] = packet_;
            say({kBootOk});
        } else {
            say({kBootWrong});
        }
        packet_.clear();
    }

    RandomStream random_;
    std::uint64_t hold_;
    int resets_, rows_ = 0;
    int master_;
    std::string name_;
    bool listening_ = false;
    BootPacket packet_;
    std::atomic<bool> stop_{false};
    std::thread thread_;
};

std::vector<BootPacket> program(std::uint64_t seed) {
    RandomStream random(seed, "program");
    image::Image image;
    image.file = "test.hex";
    image.program[0] = 0x040100;
    image.program[2] = 0;
    for (std::uint32_t at = 0x100; at < 0x400; at += 2)
        image.program[at] = static_cast<std::uint32_t>(random.below(0xFFFFFF));
    return boot_packets(image);
}

bool no_ptys() {
    if (access("/dev/pts", R_OK) == 0 && !std::filesystem::is_empty("/dev/pts")) return false;
    WARN("no devpts at /dev/pts (a bare chroot?): skipped");
    return true;
}

void check_upload(Robot& robot, const std::vector<BootPacket>& packets) {
    double share = 0.0;
    upload(robot.name(), packets, 115200, 30.0, [&](double now) { share = now; });
    for (int i = 0; i < 1000 && !robot.ended; ++i)
        std::this_thread::sleep_for(milliseconds(5));
    CHECK(robot.ended);
    CHECK(share == 1.0);
    CHECK(robot.flash.size() == packets.size());
    for (const BootPacket& packet : packets)
        CHECK(robot.flash[packet[0] | packet[1] << 8 | packet[2] << 16] == packet);
}

}  // namespace

TEST_CASE("an upload over a line without delays needs each row once", "[bluetooth]") {
    if (no_ptys()) return;
    Robot robot(1, 0, 0);
    check_upload(robot, program(Catch::rngSeed()));
}

TEST_CASE("hellos that are held back and arrive together spoil no row", "[bluetooth]") {
    if (no_ptys()) return;
    for (std::uint64_t round = 0; round < 3; ++round) {
        const std::uint64_t seed = Catch::rngSeed() + round;
        CAPTURE(seed);
        Robot robot(seed, 900, 0);
        check_upload(robot, program(seed));
    }
}

TEST_CASE("an upload goes on where the robot was reset in its midst", "[bluetooth]") {
    if (no_ptys()) return;
    Robot robot(Catch::rngSeed(), 0, 5);
    check_upload(robot, program(Catch::rngSeed()));
}
