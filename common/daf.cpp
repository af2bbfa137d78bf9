// SPDX-License-Identifier: Apache-2.0
#include "common/daf.hpp"

#include "common/check.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

namespace aeolis {
namespace {

constexpr std::size_t record_octets = 1024, double_octets = 8, record_doubles = record_octets / double_octets;
constexpr std::size_t control_doubles = 3;  // of a summary record: next, previous, number of summaries
constexpr std::size_t id_octets = 8, nd_at = 8, ni_at = 12, name_at = 16, name_octets = 60;
constexpr std::size_t first_summary_at = 76, last_summary_at = 80, free_at = 84, format_at = 88, format_octets = 8;
constexpr std::size_t transfer_test_at = 699;
// As a file that was carried as text would no longer have it: line ends and octets beyond ASCII.
constexpr std::string_view transfer_test{"FTPSTR:\r:\n:\r\n:\r\0:\x81:\x10\xCE:ENDFTP", 28};
constexpr std::int32_t numbers_max = 124, integers_max = 250;  // [naif-daf]

class Octets {
  public:
    Octets(std::span<const std::uint8_t> file, bool big) : file_(file), big_(big) {}

    std::int32_t integer(std::size_t at) const { return static_cast<std::int32_t>(number(at, 4)); }
    double real(std::size_t at) const { return std::bit_cast<double>(number(at, double_octets)); }
    std::string text(std::size_t at, std::size_t octets) const {
        std::string text(reinterpret_cast<const char*>(file_.data()) + at, octets);
        text.erase(std::find_if(text.rbegin(), text.rend(), [](char c) { return c != ' ' && c != '\0'; }).base(),
                   text.end());
        return text;
    }
    std::size_t size() const { return file_.size(); }

  private:
    std::uint64_t number(std::size_t at, std::size_t octets) const {
        std::uint64_t value = 0;
        for (std::size_t i = 0; i < octets; ++i) value = value << 8U | file_[at + (big_ ? i : octets - 1 - i)];
        return value;
    }
    std::span<const std::uint8_t> file_;
    bool big_;
};

struct Shape {
    std::size_t numbers = 0, integers = 0;
    /// Integers are stored two to a double.
    std::size_t doubles() const { return numbers + (integers + 1) / 2; }
};

Result<DafArray> read_array(const Octets& octets, Shape shape, std::size_t at, std::string name) {
    DafArray array;
    array.name = std::move(name);
    for (std::size_t i = 0; i < shape.numbers; ++i) array.numbers.push_back(octets.real(at + i * double_octets));
    const std::size_t integers_at = at + shape.numbers * double_octets;
    for (std::size_t i = 0; i < shape.integers; ++i) array.integers.push_back(octets.integer(integers_at + i * 4));
    const std::int64_t last = array.integers.back(), first = array.integers[shape.integers - 2];
    array.integers.resize(shape.integers - 2);
    if (first < 1 || last < first || static_cast<std::uint64_t>(last) > octets.size() / double_octets)
        return Error{"array '" + array.name + "' lies at " + std::to_string(first) + " to " + std::to_string(last) +
                     ", the file has " + std::to_string(octets.size() / double_octets) + " numbers"};
    array.data.reserve(static_cast<std::size_t>(last - first + 1));
    for (std::int64_t i = first; i <= last; ++i)
        array.data.push_back(octets.real(static_cast<std::size_t>(i - 1) * double_octets));
    return array;
}

void put(std::vector<std::uint8_t>& file, std::size_t at, std::uint64_t value, std::size_t octets) {
    if (file.size() < at + octets) file.resize(at + octets);
    for (std::size_t i = 0; i < octets; ++i) file[at + i] = static_cast<std::uint8_t>(value >> 8U * i);
}
void put_real(std::vector<std::uint8_t>& file, std::size_t at, double value) {
    put(file, at, std::bit_cast<std::uint64_t>(value), double_octets);
}
void put_integer(std::vector<std::uint8_t>& file, std::size_t at, std::size_t value) {
    put(file, at, value, 4);
}
void put_text(std::vector<std::uint8_t>& file, std::size_t at, std::string_view text, std::size_t octets) {
    if (file.size() < at + octets) file.resize(at + octets);
    for (std::size_t i = 0; i < octets; ++i) file[at + i] = static_cast<std::uint8_t>(i < text.size() ? text[i] : ' ');
}

}  // namespace

Result<Daf> read_daf(std::span<const std::uint8_t> file) {
    const Octets either{file, false};
    if (file.size() < record_octets || either.text(0, 4) != "DAF/")
        return Error{"is no binary kernel of SPICE: it does not begin with DAF/"};
    const std::string format = either.text(format_at, format_octets);
    if (format != "LTL-IEEE" && format != "BIG-IEEE")
        return Error{"has numbers of the format '" + format + "', which is not read (LTL-IEEE and BIG-IEEE are)"};
    const Octets octets{file, format == "BIG-IEEE"};
    const std::int32_t numbers = octets.integer(nd_at), integers = octets.integer(ni_at);
    if (numbers < 0 || numbers > numbers_max || integers < 2 || integers > integers_max)
        return Error{"has summaries of " + std::to_string(numbers) + " numbers and " + std::to_string(integers) +
                     " integers, which no kernel has"};
    const Shape shape{static_cast<std::size_t>(numbers), static_cast<std::size_t>(integers)};
    Daf daf;
    daf.kind = either.text(4, id_octets - 4);
    const std::size_t records = file.size() / record_octets;
    double next = octets.integer(first_summary_at);
    for (std::size_t read = 0; next != 0.0; ++read) {
        // A record of summaries and its record of names; a chain that is longer than the file goes round.
        if (!(next >= 1.0 && next < static_cast<double>(records)) || next != std::floor(next) || read >= records)
            return Error{"has a chain of summaries that leaves the file or goes round"};
        const std::size_t at = (static_cast<std::size_t>(next) - 1) * record_octets;
        const double count = octets.real(at + 2 * double_octets);
        const std::size_t count_max = (record_doubles - control_doubles) / shape.doubles();
        if (!(count >= 0.0 && count <= static_cast<double>(count_max)))
            return Error{"has a record of summaries with an impossible number of them"};
        const std::size_t name_length = shape.doubles() * double_octets;
        for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
            auto array = read_array(octets, shape, at + (control_doubles + i * shape.doubles()) * double_octets,
                                    octets.text(at + record_octets + i * name_length, name_length));
            if (!array) return array.error();
            daf.arrays.push_back(std::move(*array));
        }
        next = octets.real(at);
    }
    return daf;
}

std::vector<std::uint8_t> write_daf(const Daf& daf, std::string_view program) {
    AEOLIS_CHECK(!daf.arrays.empty());
    const Shape shape{daf.arrays.front().numbers.size(), daf.arrays.front().integers.size() + 2};
    AEOLIS_CHECK(daf.arrays.size() <= (record_doubles - control_doubles) / shape.doubles());
    constexpr std::size_t summaries_at = record_octets, names_at = 2 * record_octets, data_at = 3 * record_octets;
    std::vector<std::uint8_t> file(data_at);
    put_text(file, 0, "DAF/" + daf.kind, id_octets);
    put_integer(file, nd_at, shape.numbers);
    put_integer(file, ni_at, shape.integers);
    put_text(file, name_at, program, name_octets);
    put_integer(file, first_summary_at, summaries_at / record_octets + 1);
    put_integer(file, last_summary_at, summaries_at / record_octets + 1);
    put_text(file, format_at, "LTL-IEEE", format_octets);
    put_text(file, transfer_test_at, transfer_test, transfer_test.size());
    put_text(file, names_at, "", record_octets);
    put_real(file, summaries_at + 2 * double_octets, static_cast<double>(daf.arrays.size()));
    std::size_t address = data_at / double_octets + 1;
    for (std::size_t i = 0; i < daf.arrays.size(); ++i) {
        const DafArray& array = daf.arrays[i];
        AEOLIS_CHECK(array.numbers.size() == shape.numbers && array.integers.size() + 2 == shape.integers);
        std::size_t at = summaries_at + (control_doubles + i * shape.doubles()) * double_octets;
        for (const double number : array.numbers) put_real(file, at, number), at += double_octets;
        for (const std::int32_t integer : array.integers)
            put_integer(file, at, static_cast<std::uint32_t>(integer)), at += 4;
        put_integer(file, at, address);
        put_integer(file, at + 4, address + array.data.size() - 1);
        put_text(file, names_at + i * shape.doubles() * double_octets, array.name, shape.doubles() * double_octets);
        for (const double number : array.data) put_real(file, (address++ - 1) * double_octets, number);
    }
    put_integer(file, free_at, address);
    file.resize((file.size() + record_octets - 1) / record_octets * record_octets);
    return file;
}

}  // namespace aeolis
