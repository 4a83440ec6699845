#include "toy_run.h"

#include "base/random.h"

#include <fmt/format.h>

namespace puckloop::cosim::toy {

Run random_chatter(std::uint64_t seed, int count) {
    RandomStream random(seed, "graph");
    Run run;
    std::vector<int> uarts(static_cast<std::size_t>(count)), signals(static_cast<std::size_t>(count));
    const auto link = [&](std::size_t a, std::size_t b) {
        const bool is_uart = random.below(2) == 0;
        auto& used = is_uart ? uarts : signals;
        const char* kind = is_uart ? "uart" : "signals";
        LinkSpec spec{fmt::format("link{}", run.links.size()),
                      {fmt::format("n{}", a), fmt::format("{}{}", kind, used[a]++)},
                      {}};
        spec.b = {fmt::format("n{}", b), fmt::format("{}{}", kind, used[b]++)};
        if (is_uart)
            spec.nominal_baud = 115200.0;
        else if (random.below(3) == 0)
            spec.latency = static_cast<Time>(random.below(5)) * kMicrosecond;
        run.links.push_back(spec);
    };
    for (int n = 1; n < count; ++n)
        link(random.below(static_cast<std::uint64_t>(n)), static_cast<std::size_t>(n));
    for (int extra = 0; extra < count / 2; ++extra) {
        const std::size_t a = random.below(static_cast<std::uint64_t>(count));
        const std::size_t b = random.below(static_cast<std::uint64_t>(count));
        if (a != b) link(a, b);
    }
    for (int n = 0; n < count; ++n) {
        const auto i = static_cast<std::size_t>(n);
        // Node 0 answers without any delay, so that chains through it have zero length.
        run.nodes.push_back(
            {fmt::format("n{}", n),
             fmt::format("chatter seed={} uarts={} signals={} think_us={} fly_us={} early={} gap_us={}",
                         seed * 100 + i, uarts[i], signals[i], n == 0 ? 0 : 1 + random.below(9),
                         n == 0 ? 0 : 1 + random.below(20), random.below(2), 60 + random.below(400))});
    }
    run.options.duration = 20 * kMillisecond;
    run.options.in_process = true;
    return run;
}

}  // namespace puckloop::cosim::toy
