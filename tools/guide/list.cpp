// `puckloop list`: scenarios, experiments, campaigns and images, each with its first line.

#include "base/error.h"
#include "base/files/shipped_files.h"
#include "base/json.h"
#include "base/sha256.h"
#include "tools/cli/check.h"
#include "tools/cli/command.h"
#include "tools/guide/first_line.h"
#include "tools/guide/guide.h"
#include "tools/guide/image_catalogue.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <set>
#include <vector>

namespace puckloop::tools {

namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

struct ListOptions {
    std::string what;
    bool json = false;
};

struct Row {
    std::string name;
    fs::path file;
    std::string about;
};

std::vector<fs::path> files_with(const fs::path& folder, const std::set<std::string>& endings) {
    std::vector<fs::path> files;
    std::error_code error;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder, error))
        if (entry.is_regular_file(error) && endings.count(entry.path().extension().string()) > 0)
            files.push_back(entry.path());
    std::sort(files.begin(), files.end());
    return files;
}

/// `known`: one that is certainly there.
std::vector<Row> toml_files(const std::string& known) {
    std::vector<Row> rows;
    const fs::path one = shipped_file(known);
    if (one.empty()) return rows;
    for (const fs::path& file : files_with(one.parent_path(), {".toml"}))
        rows.push_back({file.stem().string(), file, first_comment(file)});
    return rows;
}

/// Experiments of laboratories, as ARGoS has them.
std::vector<Row> argos_files() {
    std::vector<Row> rows;
    const fs::path one = shipped_file("scenarios/aggregation.argos");
    if (one.empty()) return rows;
    for (const fs::path& file : files_with(one.parent_path(), {".argos"}))
        rows.push_back({file.filename().string(), file, first_comment(file)});
    return rows;
}

/// The project's own images, then those of PUCKLOOP_IMAGES.
std::vector<Row> images() {
    std::vector<Row> rows;
    constexpr std::pair<const char*, const char*> kOwn[] = {
        {"epuck.hex", "own firmware of the main board"},
        {"epuck_ircom.hex", "the same with IRcom"},
        {"rab.hex", "own firmware of the range-and-bearing board"},
        {"tam.elf", "own firmware of a TAM, made by the build"},
        {"camera.hex", "takes pictures and sends them over UART1"},
        {"talk.hex", "talks over the Bluetooth module"},
        {"network.hex", "a team that says hello over WiFi or Bluetooth"},
        {"can.hex", "talks on a CAN bus (main board)"},
        {"ecan.hex", "talks on a CAN bus (range-and-bearing board)"},
        {"sound.hex", "plays sounds"},
        {"ears.hex", "samples the microphones"}};
    for (const auto& [name, about] : kOwn)
        if (const fs::path file = shipped_image(name); !file.empty()) rows.push_back({name, file, about});
    for (const fs::path& file : files_with(images_folder(), {".hex", ".elf", ".cof"})) {
        const CataloguedImage* known = catalogued(sha256_of_file(file));
        rows.push_back({file.filename().string(), file, known != nullptr ? std::string(known->about) : ""});
    }
    return rows;
}

ordered_json as_json(const std::vector<Row>& rows) {
    ordered_json list = ordered_json::array();
    for (const Row& row : rows)
        list.push_back({{"name", row.name}, {"file", row.file.string()}, {"about", row.about}});
    return list;
}

void print(const char* title, const std::vector<Row>& rows) {
    constexpr std::size_t kWidest = 30;
    std::size_t width = 0;
    for (const Row& row : rows)
        width = std::max(width, std::min(row.name.size(), kWidest));
    fmt::print("{}{}\n", title, rows.empty() ? ": none found" : "");
    for (const Row& row : rows)
        fmt::print("  {:<{}}  {}\n", row.name, width, row.about);
}

int list(const ListOptions& options) {
    ordered_json all{{"format", 1}};
    const bool every = options.what.empty();
    const auto one = [&](const char* what, const char* title, const auto& rows_of) {
        if (!every && options.what != what) return;
        const std::vector<Row> rows = rows_of();
        if (options.json)
            all[what] = as_json(rows);
        else
            print(title, rows);
    };
    one("scenarios", "Scenarios (puckloop run NAME)", [] { return toml_files("scenarios/hello.toml"); });
    one("argos", "Experiments of ARGoS (puckloop run NAME --linux PROGRAM)", [] { return argos_files(); });
    one("experiments", "Experiments (puckloop experiment NAME)",
        [] { return toml_files("scenarios/experiments/aggregation.toml"); });
    one("campaigns", "Campaigns (puckloop faults campaign FILE)",
        [] { return toml_files("campaigns/own.toml"); });
    one("images", "Images (firmware = \"NAME\"; puckloop exec FILE)", [] { return images(); });
    if (options.json)
        fmt::print("{}\n", all.dump(2));
    else if ((every || options.what == "images") && images_folder().empty())
        fmt::print("Third-party images: set PUCKLOOP_IMAGES to their folder (puckloop images).\n");
    return 0;
}

}  // namespace

void declare_list(Command& app, int& status) {
    auto options = std::make_shared<ListOptions>();
    Command* command =
        app.add_subcommand("list", "scenarios, experiments, campaigns and images, each with its first line");
    command->add_option("what", options->what, "only these")
        ->check(one_of({"scenarios", "argos", "experiments", "campaigns", "images"}))
        ->type_name("scenarios|argos|experiments|campaigns|images");
    command->add_flag("--json", options->json, "print one JSON object, with the files' places");
    command->callback([options, &status] { status = list(*options); });
}

}  // namespace puckloop::tools
