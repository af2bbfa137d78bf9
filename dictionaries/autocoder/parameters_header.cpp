// SPDX-License-Identifier: Apache-2.0
#include "dictionaries/autocoder/parameters_header.hpp"

#include "dictionaries/autocoder/cpp_text.hpp"

#include <algorithm>
#include <sstream>

namespace aeolis::dictionary::autocoder {
namespace {

using Change = ParameterRow::Change;

template <typename Write>
void each_row(const Dictionary& dictionary, Change change, Write&& write) {
    for (const ParameterRow& row : dictionary.parameters)
        if (row.change == change) write(row);
}

void write_members(const Dictionary& dictionary, Change change, std::ostringstream& out) {
    each_row(dictionary, change, [&](const ParameterRow& row) {
        out << "    double " << row.name << " = " << double_literal(row.default_value) << ";  ///< [" << row.unit
            << "] " << row.text << "\n";
    });
}

void write_specs(const Dictionary& dictionary, std::ostringstream& out) {
    out << "struct ParameterSpec {\n"
           "    double Parameters::*member = nullptr;  ///< null: fixed at build\n"
           "    double fixed = 0.0;                    ///< value of one that is fixed\n"
           "    double min = 0.0, max = 0.0;           ///< what ground may change it to\n"
           "};\n"
           "inline constexpr std::size_t parameter_count = "
        << dictionary.parameters.size()
        << ";\n/// By id.\ninline constexpr std::array<ParameterSpec, parameter_count> parameter_specs{{\n";
    for (const ParameterRow& row : dictionary.parameters) {
        const bool fixed = row.change == Change::build;
        out << "    {" << (fixed ? "nullptr" : "&Parameters::" + row.name) << ", "
            << (fixed ? "build_parameters." + row.name : "0.0") << ", " << double_literal(row.min) << ", "
            << double_literal(row.max) << "},\n";
    }
    out << "}};\n\n";
}

void write_ids(const Dictionary& dictionary, std::ostringstream& out) {
    out << "namespace parameter {\n";
    for (const ParameterRow& row : dictionary.parameters)
        out << "inline constexpr ParameterId " << row.name << "{" << row.id.value << "};\n";
    out << "}  // namespace parameter\n\n";
}

}  // namespace

std::string parameters_header(const Dictionary& dictionary) {
    std::ostringstream out;
    out << made_by_autocoder(dictionary, "parameters.csv")
        << "#pragma once\n\n#include \"common/ids.hpp\"\n\n#include <array>\n#include <cstddef>\n\n"
           "namespace aeolis::flight {\n\n"
           "/// What ground may change until GNC is enabled, at its defaults.\nstruct Parameters {\n";
    write_members(dictionary, Change::until_gnc, out);
    out << "\n    bool operator==(const Parameters&) const = default;\n";
    out << "};\n\n/// What is fixed when flight is built.\nstruct BuildParameters {\n";
    write_members(dictionary, Change::build, out);
    out << "};\ninline constexpr BuildParameters build_parameters{};\n\n";
    write_specs(dictionary, out);
    write_ids(dictionary, out);
    out << "}  // namespace aeolis::flight\n";
    return out.str();
}

std::string parameter_names_header(const Dictionary& dictionary) {
    std::ostringstream out;
    out << made_by_autocoder(dictionary, "parameters.csv")
        << "#pragma once\n\n#include <array>\n#include <string_view>\n\nnamespace aeolis::flight {\n\n/// By id.\n"
           "inline constexpr std::array<std::string_view, "
        << dictionary.parameters.size() << "> parameter_names{\n";
    for (const ParameterRow& row : dictionary.parameters) out << "    \"" << row.name << "\",\n";
    out << "};\n\n}  // namespace aeolis::flight\n";
    return out.str();
}

}  // namespace aeolis::dictionary::autocoder
