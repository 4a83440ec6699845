#include "run/report/provenance.h"

#include "base/json.h"
#include "base/sha256.h"
#include "base/version/version.h"
#include "cosim/faults/spec/flash.h"

#include <fstream>
#include <map>

namespace puckloop::tools {

using nlohmann::ordered_json;

std::vector<UsedFile> used_files(const RunSetup& setup) {
    std::vector<UsedFile> files;
    std::map<std::string, std::string> known;  // robots of a swarm share theirs
    const auto add = [&](const std::string& node, const char* role, const std::string& file) {
        if (file.empty()) return;
        const auto [place, fresh] = known.try_emplace(file);
        // A program may be executed and not read.
        if (fresh && std::ifstream(file)) place->second = sha256_of_file(file);
        files.push_back({node, role, file, place->second});
    };
    for (const PlannedNode& node : setup.nodes) {
        if (const auto* linux = std::get_if<LinuxProgram>(&node.what.kind))
            add(node.name, "program", linux->program.program);
        if (!has_board(node.what)) continue;
        NodeDescription board = node.what;
        add(node.name, "firmware", board_fields(board).firmware);
        if (const auto* tam = std::get_if<tam::TamSpec>(&node.what.kind))
            add(node.name, "firmware", tam->boot_loader);
    }
    return files;
}

std::vector<UsedFile> flashed_files(const RunSetup& setup) {
    std::vector<UsedFile> files;
    for (const cosim::FaultSpec& fault : setup.scenario.faults) {
        if (fault.kind != cosim::kFlashKind) continue;
        const std::string file = fault.parameters.text("image");
        std::string hash = fault.parameters.text("sha256");
        if (hash.empty() && std::ifstream(file)) hash = sha256_of_file(file);
        files.push_back({fault.node, "flashed", file, hash});
    }
    return files;
}

ordered_json files_json(const std::vector<UsedFile>& files) {
    ordered_json list = ordered_json::array();
    for (const UsedFile& file : files)
        list.push_back({{"node", file.node},
                        {"role", file.role},
                        {"file", file.file},
                        {"sha256", file.sha256.empty() ? ordered_json(nullptr) : ordered_json(file.sha256)}});
    return list;
}

ordered_json version_json() {
    const Version& version = program_version();
    return {{"version", version.number}, {"commit", version.commit}, {"modified", version.modified}};
}

ordered_json command_line_json() {
    std::ifstream stream("/proc/self/cmdline", std::ios::binary);
    ordered_json words = ordered_json::array();
    for (std::string word; std::getline(stream, word, '\0');)
        words.push_back(word);
    return words;
}

}  // namespace puckloop::tools
