#pragma once
// A table of what a sweep found, written as CSV into the folder that PUCKLOOP_TABLES names, if it does.

#include <cstdlib>
#include <fstream>
#include <string>

namespace puckloop::framing {

class Table {
  public:
    Table(const std::string& file, const std::string& columns) {
        if (const char* folder = std::getenv("PUCKLOOP_TABLES")) out_.open(std::string(folder) + "/" + file);
        add(columns);
    }
    void add(const std::string& row) {
        if (out_.is_open()) out_ << row << '\n';
    }

  private:
    std::ofstream out_;
};

}  // namespace puckloop::framing
