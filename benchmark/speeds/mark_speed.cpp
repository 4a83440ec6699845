#include "benchmark/speeds/mark_speed.h"

#include "emu/image/image.h"
#include "emu/pic/pic_node.h"
#include "emu/rab_board/rab_node.h"

#include <chrono>
#include <memory>
#include <vector>

namespace puckloop::tools {

namespace {

constexpr cosim::Time kMarkStartUp = 100 * cosim::kMillisecond;
constexpr cosim::Time kStretch = 200 * cosim::kMicrosecond;

std::unique_ptr<cosim::Node> make(const std::filesystem::path& path, MarkedBoard board) {
    const image::Image image = image::load_image(path.string());
    if (board == MarkedBoard::Main) return std::make_unique<pic::PicNode>(image, pic::PicNodeOptions{});
    return std::make_unique<rab::RabNode>(image, rab::RabNodeOptions{});
}

}  // namespace

double mark_speed(const std::filesystem::path& image, MarkedBoard board, GoingBack what, double wall_s) {
    using Clock = std::chrono::steady_clock;
    const auto seconds = [](Clock::duration time) { return std::chrono::duration<double>(time).count(); };
    const auto node = make(image, board);
    cosim::Rewindable& back = *node->rewindable();
    std::vector<cosim::Message> outbox;
    cosim::Time now = kMarkStartUp;
    node->advance(now, {}, outbox);
    const auto start = Clock::now();
    Clock::duration marking{}, rewinding{};
    double count = 0;
    do {
        const auto before_mark = Clock::now();
        back.mark();
        marking += Clock::now() - before_mark;
        node->advance(now + kStretch, {}, outbox);
        const auto before_rewind = Clock::now();
        back.rewind();
        rewinding += Clock::now() - before_rewind;
        now += kStretch;
        node->advance(now, {}, outbox);
        outbox.clear();
        ++count;
    } while (seconds(Clock::now() - start) < wall_s);
    constexpr double kMicroseconds = 1e6;
    return count / (seconds(what == GoingBack::Mark ? marking : rewinding) * kMicroseconds);
}

}  // namespace puckloop::tools
