#pragma once
// Lines of commands: from a terminal with editing, completion and history (libedit), else as they come.

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace puckloop::exec::debugger {

class LineEditor {
  public:
    /// `complete` returns what the last word of a line may become, the line up to there being given.
    /// `history` names the file, among those of the user's state, that keeps lines of a terminal.
    explicit LineEditor(std::function<std::vector<std::string>(const std::string& line)> complete,
                        const std::string& history = "debug_history");
    ~LineEditor();
    LineEditor(const LineEditor&) = delete;
    LineEditor& operator=(const LineEditor&) = delete;

    /// Standard input and output are a terminal.
    static bool at_terminal();
    bool interactive() const { return interactive_; }
    /// The next line without its end; nothing: there are no more. In a script the prompt and line are shown,
    /// so that what is printed reads like a session.
    std::optional<std::string> read();

  private:
    bool interactive_ = false;
    std::string history_file_;  ///< empty: none is kept
};

}  // namespace puckloop::exec::debugger
