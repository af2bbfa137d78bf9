// SPDX-License-Identifier: Apache-2.0
#include "server/campaign/case_hdf5.hpp"

#include "tests/support/catch.hpp"

#include <cmath>
#include <hdf5.h>
#include <limits>

namespace server_case_hdf5_test {

using namespace aeolis;
using namespace aeolis::server::campaign;

namespace {

constexpr double none = std::numeric_limits<double>::quiet_NaN();

CaseTable some_cases() {
    CaseTable table;
    table.numbers = {1, 2, 9};
    table.outcomes = {"touchdown", "lost", "crash"};
    table.columns = {{"propellant_kg", {17.7, none, 0.0}}, {"event.sufr.e_s", {238.5, 239.25, none}}};
    return table;
}

/// A file of octets in memory, open for reading.
class OpenFile {
  public:
    explicit OpenFile(std::string octets) : octets_(std::move(octets)) {
        const hid_t access = H5Pcreate(H5P_FILE_ACCESS);
        H5Pset_fapl_core(access, 4096, false);
        H5Pset_file_image(access, octets_.data(), octets_.size());
        file_ = H5Fopen("image.h5", H5F_ACC_RDONLY, access);
        H5Pclose(access);
        REQUIRE(file_ >= 0);
    }
    OpenFile(const OpenFile&) = delete;
    OpenFile& operator=(const OpenFile&) = delete;
    ~OpenFile() { H5Fclose(file_); }

    std::vector<double> numbers(const std::string& name) const {
        const hid_t set = H5Dopen2(file_, ("cases/" + name).c_str(), H5P_DEFAULT);
        REQUIRE(set >= 0);
        const hid_t space = H5Dget_space(set);
        std::vector<double> values(static_cast<std::size_t>(H5Sget_simple_extent_npoints(space)));
        CHECK(H5Dread(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()) >= 0);
        H5Sclose(space);
        H5Dclose(set);
        return values;
    }
    std::string text(const std::string& name) const {
        const hid_t set = H5Dopen2(file_, ("cases/" + name).c_str(), H5P_DEFAULT);
        REQUIRE(set >= 0);
        const hid_t type = H5Dget_type(set);
        std::string octets(H5Dget_storage_size(set), '?');
        CHECK(H5Tis_variable_str(type) == 0);
        CHECK(H5Dread(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, octets.data()) >= 0);
        H5Tclose(type);
        H5Dclose(set);
        return octets;
    }
    std::vector<std::string> names_in_order() const {
        const hid_t group = H5Gopen2(file_, "cases", H5P_DEFAULT);
        std::vector<std::string> names;
        const auto add = [](hid_t, const char* name, const H5L_info_t*, void* into) -> herr_t {
            static_cast<std::vector<std::string>*>(into)->emplace_back(name);
            return 0;
        };
        CHECK(H5Literate(group, H5_INDEX_CRT_ORDER, H5_ITER_INC, nullptr, add, &names) >= 0);
        H5Gclose(group);
        return names;
    }
    std::string scenario() const {
        const hid_t attribute = H5Aopen(file_, "scenario", H5P_DEFAULT);
        const hid_t type = H5Aget_type(attribute);
        std::string text(H5Tget_size(type), '?');
        CHECK(H5Aread(attribute, type, text.data()) >= 0);
        H5Tclose(type);
        H5Aclose(attribute);
        return text;
    }
    std::uint64_t seed() const {
        std::uint64_t seed = 0;
        const hid_t attribute = H5Aopen(file_, "seed", H5P_DEFAULT);
        CHECK(H5Aread(attribute, H5T_NATIVE_UINT64, &seed) >= 0);
        H5Aclose(attribute);
        return seed;
    }

  private:
    std::string octets_;
    hid_t file_ = -1;
};

}  // namespace

TEST_CASE("a table of cases in HDF5 has each number as it was, in the order of the table, and of whom it is",
          "[campaign][analysis]") {
    const auto octets = hdf5_of(some_cases(), {"windy", 18'446'744'073'709'551'615U});
    REQUIRE(octets);
    const OpenFile file{*octets};
    CHECK(file.names_in_order() == std::vector<std::string>{"number", "outcome", "propellant_kg", "event.sufr.e_s"});
    CHECK(file.numbers("number") == std::vector<double>{1.0, 2.0, 9.0});
    CHECK(file.text("outcome") == std::string("touchdownlost\0\0\0\0\0crash\0\0\0\0", 27));
    const auto propellant = file.numbers("propellant_kg"), sufr = file.numbers("event.sufr.e_s");
    REQUIRE((propellant.size() == 3 && sufr.size() == 3));
    CHECK(propellant[0] == 17.7);
    CHECK(std::isnan(propellant[1]));
    CHECK(propellant[2] == 0.0);
    CHECK((sufr[0] == 238.5 && sufr[1] == 239.25 && std::isnan(sufr[2])));
    CHECK(file.scenario() == "windy");
    CHECK(file.seed() == 18'446'744'073'709'551'615U);
}

TEST_CASE("the same table makes the same HDF5 octets, and one without cases or columns is a file too",
          "[campaign][analysis]") {
    const auto once = hdf5_of(some_cases(), {"windy", 1}), again = hdf5_of(some_cases(), {"windy", 1});
    REQUIRE((once && again));
    CHECK(*once == *again);
    const auto empty = hdf5_of({}, {"", 0});
    REQUIRE(empty);
    CHECK(OpenFile{*empty}.numbers("number").empty());
}

TEST_CASE("a quantity that HDF5 cannot name is refused by its name", "[campaign][analysis]") {
    auto table = some_cases();
    table.columns.push_back(table.columns.front());
    const auto twice = hdf5_of(table, {"windy", 1});
    REQUIRE_FALSE(twice);
    CHECK_THAT(twice.error().message, Catch::Contains("'propellant_kg'"));
}

}  // namespace server_case_hdf5_test
