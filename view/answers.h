#pragma once
// What a page asks for and gets: the parts of the page itself, and what was derived from the folder. Nothing
// else has an address, so no address leads to a file.

#include "view/events/read_events.h"
#include "view/live/driver.h"
#include "view/recording/recording.h"

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace puckloop::view {

struct Content {
    std::string type;  ///< media type
    std::string body;
    bool own_style = false;  ///< a page with its style in itself; a browser refuses it otherwise
};

class Answers {
  public:
    /// Both must outlive it.
    Answers(const Recording& recording, const EventReader& events)
        : recording_(recording), latest_([&events] {
              return std::shared_ptr<const EventReader>(std::shared_ptr<void>(), &events);
          }) {}
    /// Of a run that goes on: the latest events, and what drives it. Both must outlive it.
    Answers(const Recording& recording, std::function<std::shared_ptr<const EventReader>()> latest,
            Driver& driver)
        : recording_(recording), latest_(std::move(latest)), driver_(&driver) {}

    /// `target` is what follows the token: "", "page.js", "events?from=0". Nothing: there is no such thing,
    /// or the numbers in it are none. Throws RunError for damaged files.
    std::optional<Content> get(std::string_view target) const;

    static constexpr std::size_t kMostEvents = 200'000;  ///< of an answer
    static constexpr std::size_t kMostTexts = 500;
    static constexpr std::size_t kMostFound = 100'000;
    static constexpr std::size_t kLongestSearch = 200;  ///< bytes

  private:
    static std::optional<Content> texts(const EventReader& events, std::string_view query);
    static std::optional<Content> find(const EventReader& events, std::string_view query);
    std::optional<Content> serial(std::string_view query) const;
    std::optional<Content> picture(std::string_view query) const;
    std::vector<std::string> robot_names() const;

    const Recording& recording_;
    std::function<std::shared_ptr<const EventReader>()> latest_;
    Driver* driver_ = nullptr;
};

/// "%2e" and "+" as they are meant; nothing for a broken escape.
std::optional<std::string> unescaped(std::string_view text);

}  // namespace puckloop::view
