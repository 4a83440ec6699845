#include "tools/viewer/serve.h"

#include "tools/viewer/browser.h"
#include "view/answers.h"
#include "view/events/event_passes.h"
#include "view/live/driver.h"
#include "view/recording/feed.h"

#include <fmt/format.h>

#include <cstdio>
#include <memory>
#include <optional>

namespace puckloop::tools {

void serve_until_interrupted(view::HttpServer& server, const std::string& rest) {
    fmt::print("{}{}\nopen this address in a browser; Ctrl-C ends\n", server.address(), rest);
    std::fflush(stdout);
    server.serve();
    const auto& counts = server.counts();
    std::string refused;
    for (std::size_t i = 0; i < view::kRefusals; ++i)
        if (counts.refused[i] > 0)
            refused += fmt::format("{}{} ({})", refused.empty() ? "" : ", ", counts.refused[i],
                                   name_of(static_cast<view::Refusal>(i)));
    fmt::print("\n{} requests answered{}\n", counts.answered, refused.empty() ? "" : "; refused: " + refused);
    std::fflush(stdout);
}

void serve_live(const std::string& folder, int port, bool opens) {
    view::Driver driver(folder);  // from here on the run's files are its own, not an earlier run's
    const view::Recording recording(folder, true);
    const view::EventPasses passes(recording, {[&] { return driver.on(); }, [&] { return driver.epoch(); },
                                               [&] { return driver.stands(); }});
    const view::Answers answers(
        recording, [&] { return passes.latest(); }, driver);
    view::HttpServer server(
        static_cast<std::uint16_t>(port), [&](std::string_view target) { return answers.get(target); },
        [&](std::string_view target, const std::string& body) -> std::optional<view::HttpServer::Posted> {
            if (target != "drive") return std::nullopt;
            const std::string why = driver.request(body);
            if (why.empty()) return view::HttpServer::Posted{true, {"application/json", driver.state()}};
            return view::HttpServer::Posted{false, {"text/plain; charset=utf-8", why}};
        },
        [&](std::string_view target) -> view::HttpServer::Feed {
            if (target != "live") return nullptr;
            return [feed = std::make_shared<view::Feed>(
                        recording,
                        view::Feed::Source{[&] { return driver.state(); }, [&] { return driver.epoch(); }})] {
                return feed->next();
            };
        });
    fmt::print(stderr, "puckloop: the run stands still until the page lets it go on\n");
    std::optional<OpenedPage> page;
    if (opens) page.emplace(server.address());
    serve_until_interrupted(server);
}

}  // namespace puckloop::tools
