#include "scenarios/argos/import.h"

#include "scenarios/argos/arena.h"
#include "scenarios/argos/toml_tree.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

namespace puckloop::argos {

namespace {

void add_run(XmlFile& file, Tree& root) {
    const pugi::xml_node framework = file.root().child("framework");
    const pugi::xml_node experiment = framework.child("experiment");
    if (!experiment)
        file.fail(framework ? framework : file.root(), "there is no <framework> with <experiment>",
                  "<framework><experiment length=\"120\" ticks_per_second=\"10\"/></framework>");
    Tree run(file.line_of(experiment));
    const double length = file.number(experiment, "length", 0.0);
    if (length < 0.0) file.fail(experiment, "<experiment>: length is below 0", "seconds");
    if (length > 0.0)
        run.quantity("duration", length, "s");
    else
        file.note(experiment, "an experiment of length 0 has no end: --duration gives one");
    const auto seed = file.integer(experiment, "random_seed", 0, std::numeric_limits<std::int64_t>::max(), 0);
    if (seed != 0)
        run.integer("seed", seed);
    else if (experiment.attribute("random_seed"))
        file.note(experiment,
                  "random_seed 0 means another seed each time: here it is 1 (--seed N gives another)");
    root.table("run", run);
}

bool is_empty(pugi::xml_node node) {
    const auto children = node.children();
    return std::none_of(children.begin(), children.end(),
                        [](pugi::xml_node child) { return child.type() == pugi::node_element; });
}

void note_sections(XmlFile& file) {
    for (const pugi::xml_node node : file.root().children()) {
        if (node.type() != pugi::node_element) continue;
        const std::string_view name = node.name();
        if (name == "framework" || name == "controllers" || name == "arena") continue;
        if (name == "loop_functions") {
            const std::string label = node.attribute("label").value();
            file.note(
                node,
                fmt::format("the loop functions{} are not executed: no score and no floor comes from them",
                            label.empty() ? "" : " '" + label + "'"));
        } else if (name == "media") {
            if (!is_empty(node))
                file.note(node,
                          "<media>: light, radio and range and bearing are those of the emulated hardware");
        } else if (name == "physics_engines") {
            if (!is_empty(node)) file.note(node, "<physics_engines>: the world has its own (ODE)");
        } else if (name == "visualization") {
            if (!is_empty(node)) file.note(node, "<visualization> is not taken over");
        } else {
            file.note(node, fmt::format("<{}> is not known and not taken over", name));
        }
    }
}

}  // namespace

bool is_experiment(const std::filesystem::path& file) {
    return file.extension() == ".argos" || file.extension() == ".xml";
}

Imported import_experiment(const std::filesystem::path& path, const Options& options) {
    XmlFile file(path);
    if (std::string_view(file.root().name()) != "argos-configuration")
        file.fail(file.root(), fmt::format("<{}> is no ARGoS experiment", file.root().name()),
                  "<argos-configuration>");
    Tree root(file.line_of(file.root()));
    add_run(file, root);
    add_arena(file, options, root);
    note_sections(file);
    std::vector<Note> notes = file.notes();
    std::stable_sort(notes.begin(), notes.end(),
                     [](const Note& a, const Note& b) { return a.line < b.line; });
    return {root.value(), std::move(notes)};
}

}  // namespace puckloop::argos
