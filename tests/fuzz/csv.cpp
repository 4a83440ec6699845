// Lines of tables of numbers, with each separator.

#include "base/text/csv.h"
#include "tests/fuzz/target.h"

void puckloop::fuzz::run_input(Input input) {
    const std::string_view line = text_of(input);
    for (const char separator : {',', ';', '\t', ' '})
        for (const std::string_view cell : csv_cells(line, separator)) {
            require(cell.empty() || (cell.data() >= line.data() &&
                                     cell.data() + cell.size() <= line.data() + line.size()),
                    "cells inside their line");
            double value = 0.0;
            csv_number(cell, value);
        }
}
