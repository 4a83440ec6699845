#pragma once
// Who reaches whom: robots that are no further apart than one hop are neighbours; over neighbours a message
// goes on, hop by hop.

#include "linuxboard/netmanager/message.h"

#include <cstddef>
#include <map>
#include <optional>
#include <vector>

namespace puckloop::netmanager {

struct Limits {
    /// Largest distance of one hop, m; nothing: everybody is everybody's neighbour.
    std::optional<double> range{};
    int hops = 1;  ///< most of a message, 1 or more
};

/// By number of the robot; where its place is not known it is near to all.
using Places = std::map<int, std::optional<Place>>;

/// Smallest number of hops from robot `from` to each of the others that it reaches within the limits.
std::map<int, int> reached(const Places& places, int from, const Limits& limits);

}  // namespace puckloop::netmanager
