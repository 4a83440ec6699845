#include "run/expectations/test_report.h"

#include "base/error.h"
#include "base/files/text_file.h"
#include "base/plain_text.h"
#include "run/expectations/judge_expectations.h"

#include <fmt/format.h>
#include <pugixml.hpp>

#include <sstream>

namespace puckloop::tools {

namespace {

constexpr const char* kRun = "the run goes on to its end";
constexpr std::size_t kLongestText = 2000;

std::string failure_of(const TestSuite& suite, const ExpectationResult& result) {
    return fmt::format("{}: {}: {}", suite.scenario, result.place, unmet_text(result));
}

/// What XML and a line of TAP can hold.
std::string shown(const std::string& text) {
    return plain_text(text, kLongestText);
}

void add_case(pugi::xml_node to, const TestSuite& suite, const std::string& name, double seconds,
              const std::string& failure) {
    pugi::xml_node one = to.append_child("testcase");
    one.append_attribute("classname") = ("puckloop." + suite.name).c_str();
    one.append_attribute("name") = shown(name).c_str();
    one.append_attribute("time") = fmt::format("{:.3f}", seconds).c_str();
    if (failure.empty()) return;
    pugi::xml_node why = one.append_child("failure");
    why.append_attribute("message") = shown(failure).c_str();
    why.text().set(shown("results in " + suite.out).c_str());
}

/// A number sign begins a directive.
std::string tap_name(const std::string& name) {
    std::string text = shown(name);
    for (std::size_t at = 0; (at = text.find('#', at)) != std::string::npos; at += 2)
        text.insert(at, 1, '\\');
    return text;
}

void add_line(std::string& to, std::size_t number, const std::string& name, const std::string& failure) {
    to += fmt::format("{} {} - {}\n", failure.empty() ? "ok" : "not ok", number, tap_name(name));
    if (!failure.empty()) to += fmt::format("# {}\n", shown(failure));
}

}  // namespace

std::string junit_text(const TestSuite& suite) {
    pugi::xml_document document;
    pugi::xml_node declaration = document.append_child(pugi::node_declaration);
    declaration.append_attribute("version") = "1.0";
    declaration.append_attribute("encoding") = "UTF-8";
    pugi::xml_node root = document.append_child("testsuites").append_child("testsuite");
    std::size_t failures = suite.trouble.empty() ? 0 : 1;
    for (const ExpectationResult& result : suite.results)
        failures += result.met ? 0 : 1;
    root.append_attribute("name") = suite.name.c_str();
    root.append_attribute("tests") = suite.results.size() + 1;
    root.append_attribute("failures") = failures;
    root.append_attribute("errors") = 0;
    root.append_attribute("time") = fmt::format("{:.3f}", suite.wall_s).c_str();
    add_case(root, suite, kRun, suite.wall_s, suite.trouble);
    for (const ExpectationResult& result : suite.results)
        add_case(root, suite, result.name, 0.0, result.met ? "" : failure_of(suite, result));
    std::ostringstream text;
    document.save(text, "  ");
    return text.str();
}

std::string tap_text(const TestSuite& suite) {
    std::string text = fmt::format("TAP version 13\n1..{}\n", suite.results.size() + 1);
    add_line(text, 1, kRun, suite.trouble);
    for (std::size_t i = 0; i < suite.results.size(); ++i)
        add_line(text, i + 2, suite.results[i].name,
                 suite.results[i].met ? "" : failure_of(suite, suite.results[i]));
    return text;
}

void write_test_reports(const std::filesystem::path& junit, const std::filesystem::path& tap,
                        const TestSuite& suite, cosim::Outcome& outcome) {
    try {
        if (!junit.empty()) write_file(junit, junit_text(suite));
        if (!tap.empty()) write_file(tap, tap_text(suite));
    } catch (const std::exception& error) {
        if (outcome.success) outcome.text = error.what();
        outcome.success = false;
    }
}

}  // namespace puckloop::tools
