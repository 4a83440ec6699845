#pragma once
// One run of a campaign: which faults, with which seed.

#include "base/json.h"

#include <cstdint>
#include <string>
#include <vector>

namespace puckloop::faults {

struct Case {
    int id = 0;         ///< from 1, in the order of the campaign; 0: the nominal run
    std::string phase;  ///< "single", "fewer", "fewer 2" ... or "pair"
    std::string sweep;
    std::string place;  ///< column of the heat map: "byte 12", "3.5 s"; empty: none
    std::uint64_t seed = 1;
    std::vector<nlohmann::json> faults;  ///< [[fault]] tables
    int of = 0;                          ///< fewer: the case with the count that it came with
    std::string pruned;                  ///< why it is not run; empty: it is
};

nlohmann::json to_json(const Case& one);
Case case_from_json(const nlohmann::json& text);

/// "kind=drop link=robot0.uart from=robot0.pic begin=3.2s count=1": keys in the order that reads best. Faults
/// are joined by " + ".
std::string in_one_line(const std::vector<nlohmann::json>& faults);
/// "drop link=robot0.uart begin=\"3.2 s\"": what `puckloop run --fault` takes.
std::string as_words(const nlohmann::json& fault);
/// As [[fault]] tables.
std::string as_toml(const std::vector<nlohmann::json>& faults);
/// "drop on robot0.uart from robot0.pic": what heat maps and findings are sorted by.
std::string kind_and_link(const nlohmann::json& fault);
/// A value as a table of a campaign or scenario has it, without quotes.
std::string value_text(const nlohmann::json& value);

}  // namespace puckloop::faults
