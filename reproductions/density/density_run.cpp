// A run of a team that stands: its scenario, and what became of its frames.

#include "base/error.h"
#include "base/files/shipped_files.h"
#include "base/files/text_file.h"
#include "reproductions/density/density.h"
#include "reproductions/runs/scratch_run.h"
#include "scenarios/tables/world_tables.h"
#include "traces/rab_losses/results.h"

#include <fmt/format.h>

namespace puckloop::tools {

namespace {

namespace fs = std::filesystem;

constexpr double kBegun = 0.7;  // s: all programs send
constexpr double kAfter = 0.1;  // s: until the last frames have been fetched

fs::path write_scenario(const DensitySpec& spec) {
    const fs::path arena = shipped_file("scenarios/dodecagon.toml");
    if (arena.empty())
        throw InputError("", "bench density", "there is no scenarios/dodecagon.toml beside this program",
                         "a whole installation");
    std::string text = fmt::format(
        "include = \"{}\"\n[run]\nduration = \"{} s\"\nseed = {}\nallow = [\"program\"]\n"
        "[[group]]\nname = \"epuck{{n}}\"\ncount = {}\nfirst = 1\n"
        "[group.place]\nkind = \"disc\"\nradius = \"1.1 m\"\ngap = \"1 cm\"\n"
        "[group.pic]\nfirmware = \"own\"\ncrystal_error = \"normal(0, 15 ppm)\"\n"
        "[group.rab]\nfirmware = \"{}\"\ncrystal_error = \"normal(0, 15 ppm)\"\n"
        "[group.linux]\nprogram = [\"puckloop-control\", \"--behaviour\", \"still\", \"--rab-required\", "
        "\"--rab-id\", "
        "\"{{n}}\", "
        "\"--rab-emit-ms\", \"{}\", \"--rab-bytes\", \"{}\", \"--rab-poll-ms\", \"{}\", \"--duration\", "
        "\"3600\"]\n"
        "start = \"uniform(100 ms, 500 ms)\"\n",
        arena.string(), kBegun + spec.seconds + kAfter, spec.seed, spec.robots,
        fs::absolute(spec.firmware).string(), spec.emit_ms, spec.bytes, spec.poll_ms);
    if (!spec.parameters.empty()) text += "[parameters]\n";
    for (const auto& [name, value] : spec.parameters)
        text += fmt::format("{} = {}\n", name, scenarios::parameter_text(name, value));
    const fs::path file = spec.folder / "density.toml";
    write_file(file, text);
    return file;
}

}  // namespace

Density run_density(const DensitySpec& spec) {
    empty_folder(spec.folder);
    const fs::path results = run_beside(write_scenario(spec));
    const double to = kBegun + spec.seconds;
    const RabResults heard = read_rab_results(results, kBegun, to);
    if (heard.on_air.empty())
        throw RunError(
            fmt::format("{}: no board sent anything: is it a range-and-bearing image that is ready at once?",
                        spec.firmware.string()));
    const Density density = density_of(heard.losses.fates, kBegun, to);
    std::error_code ignored;
    fs::remove_all(results, ignored);  // some 10 MB a second of twenty robots
    return density;
}

}  // namespace puckloop::tools
