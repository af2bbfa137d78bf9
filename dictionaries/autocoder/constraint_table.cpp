// SPDX-License-Identifier: Apache-2.0
#include "dictionaries/autocoder/constraint_table.hpp"

#include "dictionaries/autocoder/cpp_text.hpp"

#include <sstream>

namespace aeolis::dictionary::autocoder {
namespace {

std::string moment_expression(const Dictionary& dictionary, const Moment& moment) {
    switch (moment.kind) {
    case Moment::Kind::anchor: return "Moment::of_anchor(anchor::" + dictionary.anchors[moment.index].name + ")";
    case Moment::Kind::triggered:
        return "Moment::of_triggered(timepoint::" + dictionary.timeline[moment.index].name + ")";
    case Moment::Kind::fired: return "Moment::of_fired(timepoint::" + dictionary.timeline[moment.index].name + ")";
    case Moment::Kind::do_edl: break;
    }
    return "Moment::of_do_edl()";
}

}  // namespace

std::string constraint_table(const Dictionary& dictionary) {
    std::ostringstream out;
    out << "constinit const std::array<ConstraintSpec, constraint_count> constraint_specs{{\n";
    for (const ConstraintRow& row : dictionary.constraints)
        out << "#line " << row.line << " \"constraints.csv\"\n    {" << moment_expression(dictionary, row.from) << ", "
            << moment_expression(dictionary, row.to) << ", " << optional_literal(row.minimum_s) << ", "
            << optional_literal(row.maximum_s) << "},\n";
    out << "}};\n\n";
    return out.str();
}

}  // namespace aeolis::dictionary::autocoder
