#include "tests/state/board_runs.h"

#include "emu/dspic/devices/device.h"
#include "emu/dspic/machine/isa.h"
#include "emu/pic/pic_node.h"
#include "emu/rab_board/rab_node.h"
#include "tests/kit/node_under_test.h"

#include <algorithm>
#include <cstdlib>

namespace puckloop::tests {

using cosim::Message;
using cosim::Time;

MakeBoard pic_board(const image::Image& image, bool skip_idle) {
    return [image, skip_idle] {
        pic::PicNodeOptions options;
        options.skip_idle = skip_idle;
        options.board.name = "robot0.pic";
        options.board.crystal_ppm = 17;
        return std::make_unique<pic::PicNode>(image, options);
    };
}

MakeBoard rab_board(const image::Image& image, bool skip_idle) {
    return [image, skip_idle] {
        rab::RabNodeOptions options;
        options.skip_idle = skip_idle;
        options.board.name = "robot0.rab";
        return std::make_unique<rab::RabNode>(image, options);
    };
}

image::Image own_pic_image() {
    return image::load_image(PUCKLOOP_SOURCE "/firmware/epuck/epuck.hex");
}

image::Image own_rab_image() {
    return image::load_image(PUCKLOOP_SOURCE "/firmware/rab/rab.hex");
}

std::optional<image::Image> real_image(const std::string& name) {
    const char* folder = std::getenv("PUCKLOOP_IMAGES");
    if (folder == nullptr) return std::nullopt;
    const auto path = std::filesystem::path(folder) / name;
    if (!std::filesystem::exists(path)) return std::nullopt;
    return image::load_image(path.string());
}

image::Image random_program(RandomStream& random, bool family_33f) {
    const dspic::DeviceInfo& device = family_33f ? dspic::dspic33fj256gp710() : dspic::dspic30f6014a();
    std::string source = "        .org 0x200\nmain:\n";
    for (int i = 0; i < 15; ++i)
        source += "        mov #" + std::to_string(random.below(0x2000)) + ", w" + std::to_string(i) + "\n";
    source += "        mov #0x1000, w15\n        mov #0x2700, w0\n        mov w0, SPLIM\n";
    for (const char* number : {"1", "2", "3"}) {
        const std::string period = std::to_string(200 + random.below(20000));
        source += "        mov #" + period + ", w0\n        mov w0, PR" + number + "\n        bset T" +
                  number + "CON, #15\n";
    }
    source += "        mov #0xFFFF, w0\n        mov w0, IEC0\n";
    image::Image image = assembled(device, source);
    constexpr std::uint32_t kCode = 0x300, kWords = 1500;
    const auto place = [&] { return kCode + 2 * static_cast<std::uint32_t>(random.below(kWords)); };
    constexpr std::uint32_t kVectors = 61;
    for (std::uint32_t vector = 1; vector <= kVectors; ++vector)
        image.program[device.ivt + 2 * vector] = place();
    for (std::uint32_t i = 0; i < kWords;) {
        const auto word = static_cast<std::uint32_t>(random.below(1u << 24));
        if (dspic::find_form(word) == nullptr) continue;
        image.program[kCode + 2 * i++] = word;
    }
    image.program[kCode + 2 * kWords] = 0x040200;  // goto main
    image.program[kCode + 2 * kWords + 2] = 0;
    return image;
}

image::Image self_programming(bool family_33f) {
    // At 0x1000 a loop of as many turns as rounds were made: mov #n, w4; dec w4, w4; bra nz, .-2; return
    const std::string erase = family_33f
                                  ? "        tblwtl w6, [w6]\n        mov #0x4042, w2\n"
                                  : "        mov w6, NVMADR\n        clr NVMADRU\n        mov #0x4041, w2\n";
    const std::string carrier = family_33f ? "7" : "6";  // Timer2, whose routine leaves no trace
    const std::string source = R"(
        .org 0x1A
        .pword tick
        .org )" + std::string(family_33f ? "0x22" : "0x20") +
                               R"(
        .pword trace
        .org 0x200
main:   mov #0x1000, w15
        mov #0x2700, w0
        mov w0, SPLIM
        mov #1500, w0
        mov w0, PR1
        bset T1CON, #15
        bset IEC0, #3
        mov #97, w0
        mov w0, PR2
        bset T2CON, #15
        bset IEC0, #)" + carrier +
                               R"(
        clr TBLPAG
round:  inc 0x904
        mov #300, w1
delay:  dec w1, w1
        bra nz, delay
        mov 0x900, w2
wait:   mov 0x900, w3
        cp w2, w3
        bra z, wait
        mov #0xA00, w0
        mov w0, XMODSRT
        mov #0xA0F, w0
        mov w0, XMODEND
        mov #0x8FF8, w0
        mov w0, MODCON
        mov #0xA00, w8
        mov 0x904, w2
        do #20, last
        add w2, [w8], [w8++]
last:   nop
        clr MODCON
        pwrsav #1
        mov #0x1000, w6
)" + erase + R"(        rcall go
        mov #0x1000, w6
        mov 0x904, w3
        and #0xFF, w3
        inc w3, w3
        sl w3, #4, w3
        ior #4, w3
        tblwtl w3, [w6]
        mov #0x20, w3
        tblwth w3, [w6++]
        mov #0x0204, w3
        tblwtl w3, [w6]
        mov #0xE9, w3
        tblwth w3, [w6++]
        mov #0xFFFE, w3
        tblwtl w3, [w6]
        mov #0x3A, w3
        tblwth w3, [w6++]
        clr w3
        tblwtl w3, [w6]
        mov #0x06, w3
        tblwth w3, [w6]
        mov #0x4001, w2
        rcall go
        call 0x1000
        call 0x1000
        inc 0x906
        mov 0x904, w0
        and #7, w0
        bra nz, round
        reset

go:     mov w2, NVMCON
        mov #0x55, w4
        mov w4, NVMKEY
        mov #0xaa, w4
        mov w4, NVMKEY
        bset NVMCON, #15
        nop
busy:   btsc NVMCON, #15
        bra busy
        return

tick:   push w0
        inc 0x900
        bclr IFS0, #3
        pop w0
        retfie
trace:  push w0
        mov #7, w0
        bclr IFS0, #)" + carrier +
                               R"(
        pop w0
        retfie
)";
    return assembled(family_33f ? dspic::dspic33fj256gp710() : dspic::dspic30f6014a(), source);
}

std::vector<Message> random_inputs(RandomStream& random, Time from, Time until, double busy,
                                   std::size_t signals) {
    std::vector<Message> messages;
    const double mean = 1.0 / busy;
    for (Time at = from;;) {
        at += 1 + cosim::from_seconds(2 * mean * random.uniform());
        if (at >= until) return messages;
        if (random.below(2) == 0) {
            const cosim::Signal change{static_cast<std::uint16_t>(random.below(signals)),
                                       random.uniform() * static_cast<double>(random.below(2) ? 1 : 4000)};
            messages.push_back({at, 3, change});
        } else {
            cosim::UartFrame frame;
            constexpr Time kBit115200 = 8'680'556, kBit38400 = 26'041'667;
            frame.bit_period = random.below(4) == 0 ? kBit38400 : kBit115200;
            frame.start = at - 9 * frame.bit_period;
            if (frame.start < from) continue;
            frame.data = static_cast<std::uint16_t>(random.below(256));
            messages.push_back({at, static_cast<cosim::PortIndex>(random.below(2)), frame});
        }
    }
}

Stretch random_stretch(RandomStream& random, Time from, Time until, double busy, std::size_t signals) {
    Stretch result{until, random_inputs(random, from, until, busy, signals), {}};
    const std::uint64_t cuts = 1 + random.below(4);
    for (std::uint64_t i = 0; i < cuts; ++i)
        result.cuts.push_back(from + 1 +
                              static_cast<Time>(random.below(static_cast<std::uint64_t>(until - from))));
    result.cuts.push_back(until);
    std::sort(result.cuts.begin(), result.cuts.end());
    return result;
}

std::vector<Message> run(cosim::Node& node, const Stretch& outside) {
    std::vector<Message> outbox;
    auto next = outside.inbox.begin();
    for (const Time cut : outside.cuts) {
        const auto end =
            std::find_if(next, outside.inbox.end(), [&](const Message& m) { return m.time >= cut; });
        node.advance(cut, {next, end}, outbox);
        next = end;
    }
    return outbox;
}

bool same_future(const cosim::Node& a, const cosim::Node& b) {
    for (cosim::PortIndex port = 0; port < a.ports().size(); ++port)
        if (a.earliest_output(port) != b.earliest_output(port) || a.lookahead(port) != b.lookahead(port) ||
            a.begun(port) != b.begun(port))
            return false;
    return true;
}

std::vector<std::uint8_t> saved(const cosim::StatefulNode& node) {
    std::vector<std::uint8_t> bytes;
    StateWriter writer(bytes);
    node.state(writer);
    return bytes;
}

std::unique_ptr<cosim::StatefulNode> loaded(const MakeBoard& make, const std::vector<std::uint8_t>& bytes) {
    auto node = make();
    StateReader reader(bytes);
    node->state(reader);
    reader.end();
    return node;
}

}  // namespace puckloop::tests
