#pragma once
// What the manager has passed on: counted for each link, and the last messages. Written as one line of JSON,
// for people and for puckloop's page.

#include "linuxboard/netmanager/settings.h"

#include <cstdint>
#include <deque>
#include <map>
#include <string>
#include <utility>

namespace puckloop::netmanager {

class Traffic {
  public:
    static constexpr double kWindow = 10.0;   ///< s, over which rates are
    static constexpr std::size_t kKept = 10;  ///< messages

    /// At `time`, s. `fate`: "passed", "lost", ...
    void add(double time, int from, int to, int hops, const std::string& data, const char* fate);
    /// JSON in one line without spaces: "time_s"; the settings; "robots": [[number, x, y]], without x and y
    /// where they are not known; "links": [[from, to, hops, passed, not passed, messages per s, loss]], hops
    /// 0: there is no way; "last": [[time, from, to, hops, octets, fate, data]].
    std::string status(double time, const Settings& settings, const Places& places);

  private:
    struct Link {
        std::uint64_t passed = 0, failed = 0;
        std::deque<double> recent{};  ///< times of those passed within the window
    };
    struct Last {
        double time = 0;
        int from = 0, to = 0, hops = 0;
        std::string data, fate;
    };
    std::map<std::pair<int, int>, Link> links_;
    std::deque<Last> last_;
};

}  // namespace puckloop::netmanager
