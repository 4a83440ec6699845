#pragma once
// What the user asked of one run, on top of the scenario.

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace puckloop::cosim {
class NodeHosts;
struct RunSnapshot;
}

namespace puckloop::tools {

struct RunRequest {
    std::filesystem::path scenario;
    std::vector<std::string> variables;  ///< "NAME=VALUE": in place of the scenario's [variables]
    std::filesystem::path floor;         ///< PNG file for an ARGoS experiment's floor; empty: none
    double floor_scale = 0.0;            ///< of that, pixels a metre; 0: it covers the arena
    std::filesystem::path mission;       ///< file whose [mission] scores the run; empty: the scenario's own
    std::vector<std::string> firmware;  ///< "BOARD=IMAGE": robot0.pic=x.hex, tam0=x.elf, or pic=x.hex for all
    std::vector<std::string> linux_command;  ///< replaces every robot's Linux program
    std::optional<double> linux_start;       ///< s: when every robot's Linux program is started
    std::filesystem::path overlay;           ///< empty: none
    std::filesystem::path out;               ///< empty: out/<scenario name>
    std::optional<double> duration;          ///< s
    std::optional<std::uint64_t> seed;
    std::filesystem::path save_state;  ///< where the boards' states at `save_at` go; empty: nowhere
    std::optional<double> save_at;     ///< s
    std::filesystem::path from_state;  ///< what the boards start from; empty: power-up
    std::filesystem::path save;        ///< where snapshots of the whole run go; empty: nowhere
    std::vector<double> snapshot_at;   ///< when they are taken, s
    std::filesystem::path from;        ///< the snapshot that the run goes on from; empty: it begins anew
    std::shared_ptr<const cosim::RunSnapshot> snapshot;  ///< what `from` holds
    bool same_origin = false;  ///< the snapshot is of this very run: nothing is compared
    /// File of the snapshot at a time, if not as `save` states.
    std::function<std::filesystem::path(double)> save_name{};
    bool cache = false;  ///< boots are taken from the user's cache and kept there
    bool in_process = false;
    cosim::NodeHosts* hosts = nullptr;  ///< of other machines; null: all nodes are this one's
    bool realtime = false;
    std::vector<std::string> joins;   ///< "PORT=HOST:PORT": ways into the network from outside
    bool paced = false;               ///< by the wall clock, with Linux programs in simulated time
    std::filesystem::path events;     ///< [[event]] tables in place of the scenario's; empty: none
    std::vector<std::string> faults;  ///< one line each: "drop link=robot0.uart at=2s"
    unsigned threads = 0;             ///< of this process with in_process; 0: as many as serve
    double stall_seconds = 10.0;
    bool record = false;                     ///< record.csv: every message, for `puckloop replay`
    std::vector<std::string> trace_formats;  ///< forms of the trace beside trace.csv: sr, pcapng, vcd
    std::string live;                        ///< pcapng while the run goes on; "-": standard output
    std::vector<std::string> gdb;            ///< "NODE=PLACE": boards under a debugger
    std::vector<std::string> stats;          ///< boards that are profiled: nodes, kinds, or "all"
    std::filesystem::path junit;             ///< the run as a test suite, JUnit's XML; empty: none
    std::filesystem::path tap;               ///< the same as TAP; empty: none
    bool strict = false;                     ///< a run with warnings has failed
};

}  // namespace puckloop::tools
