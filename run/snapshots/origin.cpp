#include "run/snapshots/origin.h"

#include "base/error.h"
#include "base/json.h"
#include "base/plain_text.h"
#include "base/sha256.h"
#include "cosim/faults/fault_json.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <set>

namespace puckloop::tools {

namespace {

using nlohmann::json;
namespace fs = std::filesystem;

/// Of a plan of events: how they come and where they are recorded is no part of what happens.
constexpr std::array kLeftOut{"live", "repeats", "journal"};

/// Node descriptions with the results folder as "<out>" and the scenario as "<scenario>", wherever they are,
/// and the files that they name.
class Descriptions {
  public:
    explicit Descriptions(const RunSetup& setup)
        : out_(setup.out.string()), scenario_(setup.scenario.file.string()) {}

    json of(const PlannedNode& node) {
        json spec = json::parse(dump(compared(node.what, Comparison::Run)));
        clean(spec);
        return spec;
    }
    const std::map<std::string, std::string>& files() const { return files_; }

  private:
    void clean(json& value) {
        if (value.is_object())
            for (const char* key : kLeftOut)
                value.erase(key);
        if (value.is_structured())
            for (json& one : value)
                clean(one);
        if (!value.is_string()) return;
        const auto text = value.get<std::string>();
        if (text == out_ || text.starts_with(out_ + "/")) {
            value = "<out>" + text.substr(out_.size());
        } else if (text.starts_with(scenario_)) {
            value = "<scenario>" + text.substr(scenario_.size());
        } else if (text.starts_with('/')) {
            std::error_code error;
            if (!files_.contains(text) && fs::is_regular_file(text, error))
                files_[text] = sha256_of_file(text);
        }
    }

    std::string out_, scenario_;
    std::map<std::string, std::string> files_;
};

json links_of(const RunSetup& setup) {
    json links = json::array();
    for (const cosim::LinkSpec& link : setup.links)
        links.push_back(
            {link.name, link.a.node, link.a.port, link.b.node, link.b.port, link.nominal_baud, link.latency});
    return links;
}

json run_of(const RunSetup& setup) {
    Descriptions descriptions(setup);
    json nodes = json::object();
    for (const PlannedNode& node : setup.nodes)
        nodes[node.name] = descriptions.of(node);
    return {{"nodes", nodes}, {"files", descriptions.files()}, {"links", links_of(setup)}};
}

json faults_of(const RunSetup& setup) {
    json faults = json::array();
    for (std::size_t f = 0; f < setup.scenario.faults.size(); ++f)
        faults.push_back(json(cosim::fault_to_json(setup.scenario.faults[f], setup.scenario.seed, f)));
    return faults;
}

/// The first key of `now` with another value than `then` has; empty: none.
std::string other_key(const json& then, const json& now) {
    for (const auto& [key, value] : now.items())
        if (!then.contains(key) || then[key] != value) return key;
    for (const auto& [key, value] : then.items())
        if (!now.contains(key)) return key;
    return {};
}

void check_run(json then, json now, const std::string& file, const std::set<std::string>& kept) {
    const std::string expected = "the run that was saved, but for later faults";
    for (const auto& [name, spec] : now.at("nodes").items()) {
        if (!then.at("nodes").contains(name))
            throw InputError(file, name, "was not part of the run that was saved", expected);
        if (const std::string key = other_key(then["nodes"][name], spec); !key.empty())
            throw InputError(file, name, fmt::format("its {} is another than when it was saved", key),
                             expected);
    }
    if (const std::string name = other_key(then.at("nodes"), now.at("nodes")); !name.empty())
        throw InputError(file, name, "is no part of this run", expected);
    for (const std::string& one : kept) {
        then.at("files").erase(one);
        now.at("files").erase(one);
    }
    if (const std::string name = other_key(then.at("files"), now.at("files")); !name.empty())
        throw InputError(file, name, "has changed since the run was saved", "the file as it was");
    if (then.at("links") != now.at("links")) throw InputError(file, "links", "are others", expected);
}

/// Faults that begin before `time` must be the same, in the same places of the list. Those of links may be
/// others: check_link_faults() finds whether they act.
void check_faults(const json& then, const json& now, cosim::Time time, const std::string& file) {
    const auto early = [&](const json& list, std::size_t i) {
        return i < list.size() && list[i].at("begin").get<cosim::Time>() < time &&
               !list[i].at("node").get<std::string>().empty();
    };
    for (std::size_t i = 0; i < std::max(then.size(), now.size()); ++i) {
        if (!early(then, i) && !early(now, i)) continue;
        if (i < then.size() && i < now.size() && then[i] == now[i]) continue;
        const json& fault = early(now, i) ? now[i] : then[i];
        throw InputError(file, "fault " + fault.at("name").get<std::string>(),
                         fmt::format("begins at {:g} s, before the snapshot, and {}",
                                     cosim::to_seconds(fault.at("begin").get<cosim::Time>()),
                                     early(now, i) ? "was no part of its run" : "is no part of this run"),
                         fmt::format("begin=\"{:g} s\" or later", cosim::to_seconds(time)));
    }
}

json request_json(const RunRequest& request) {
    json firmware = json::array();
    for (const std::string& assignment : request.firmware) {
        const auto equals = std::min(assignment.find('='), assignment.size() - 1);
        const std::string image = assignment.substr(equals + 1);
        std::error_code ignored;
        // The name of a shipped image stays one.
        const bool file = image.find('/') != std::string::npos || fs::exists(image, ignored);
        firmware.push_back(assignment.substr(0, equals + 1) + (file ? fs::absolute(image).string() : image));
    }
    const auto path = [](const fs::path& file) { return file.empty() ? "" : fs::absolute(file).string(); };
    json text{{"scenario", path(request.scenario)}, {"firmware", firmware},
              {"variables", request.variables},     {"floor", path(request.floor)},
              {"floor_scale", request.floor_scale}, {"program", request.linux_command},
              {"overlay", path(request.overlay)},   {"events", path(request.events)},
              {"faults", request.faults},           {"out", path(request.out)}};
    if (request.duration) text["duration"] = *request.duration;
    if (request.linux_start) text["linux_start"] = *request.linux_start;
    if (request.seed) text["seed"] = *request.seed;
    return text;
}

}  // namespace

std::string origin_of(const RunSetup& setup, const RunRequest& request) {
    return json{{"request", request_json(request)}, {"run", run_of(setup)}, {"faults", faults_of(setup)}}
        .dump(-1, ' ', true, json::error_handler_t::replace);
}

RunRequest request_from(const std::string& origin, const RunRequest& request, const std::string& file) {
    try {
        const json then = json::parse(origin).at("request");
        RunRequest all = request;
        all.scenario = then.at("scenario").get<std::string>();
        all.firmware = then.at("firmware").get<std::vector<std::string>>();
        all.variables = then.at("variables").get<std::vector<std::string>>();
        all.floor = then.at("floor").get<std::string>();
        all.floor_scale = then.at("floor_scale").get<double>();
        all.linux_command = then.at("program").get<std::vector<std::string>>();
        all.overlay = then.at("overlay").get<std::string>();
        all.events = then.at("events").get<std::string>();
        all.faults = then.at("faults").get<std::vector<std::string>>();
        all.faults.insert(all.faults.end(), request.faults.begin(), request.faults.end());
        if (all.out.empty()) all.out = then.at("out").get<std::string>();
        if (!all.duration && then.contains("duration")) all.duration = then["duration"].get<double>();
        if (then.contains("linux_start")) all.linux_start = then["linux_start"].get<double>();
        if (then.contains("seed")) all.seed = then["seed"].get<std::uint64_t>();
        return all;
    } catch (const json::exception& error) {
        throw InputError(file, "", fmt::format("does not say whose run it is: {}", reason_of(error)));
    }
}

void check_origin(const std::string& origin, const RunSetup& setup, cosim::Time time, const std::string& file,
                  const std::set<std::string>& kept) {
    try {
        const json then = json::parse(origin);
        check_run(then.at("run"), run_of(setup), file, kept);
        check_faults(then.at("faults"), faults_of(setup), time, file);
    } catch (const json::exception& error) {
        throw InputError(file, "", fmt::format("does not say whose run it is: {}", reason_of(error)));
    }
}

}  // namespace puckloop::tools
