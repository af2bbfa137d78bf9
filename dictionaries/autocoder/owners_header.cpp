// SPDX-License-Identifier: Apache-2.0
#include "dictionaries/autocoder/owners_header.hpp"

#include "dictionaries/autocoder/cpp_text.hpp"

#include <algorithm>
#include <sstream>

namespace aeolis::dictionary::autocoder {
namespace {

using Kind = OwnerRow::Kind;

template <typename Write>
void each_row(const Dictionary& dictionary, Kind kind, Write&& write) {
    for (const OwnerRow& row : dictionary.owners)
        if (row.kind == kind) write(row);
}

void write_owner_of(const Dictionary& dictionary, Kind kind, const char* type, std::ostringstream& out) {
    out << "constexpr ModuleId owner_of(" << type << " which) {\n    switch (which) {\n";
    each_row(dictionary, kind, [&](const OwnerRow& row) {
        out << "#line " << row.line << " \"owners.csv\"\n    case " << type << "::" << row.name
            << ": return ModuleId::" << row.module << ";\n";
    });
    out << "    }\n    return {};\n}\n\n";
}

}  // namespace

std::string owners_header(const Dictionary& dictionary) {
    std::ostringstream out;
    out << made_by_autocoder(dictionary, "owners.csv")
        << "#pragma once\n\n#include \"flight/kernel/message.hpp\"\n\n#include <cstddef>\n#include <cstdint>\n\n"
           "namespace aeolis::flight {\n\nenum class DeviceLine : std::uint8_t {\n";
    each_row(dictionary, Kind::device, [&](const OwnerRow& row) { out << "    " << row.name << ",\n"; });
    out << "};\ninline constexpr std::size_t device_line_count = "
        << std::ranges::count(dictionary.owners, Kind::device, &OwnerRow::kind) << ";\n\n";
    write_owner_of(dictionary, Kind::decision, "Decision", out);
    write_owner_of(dictionary, Kind::device, "DeviceLine", out);
    out << "}  // namespace aeolis::flight\n";
    return out.str();
}

}  // namespace aeolis::dictionary::autocoder
