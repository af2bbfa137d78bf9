// SPDX-License-Identifier: Apache-2.0
#include "server/tones/doppler_file.hpp"
#include "server/tones/sample_file.hpp"
#include "tests/support/catch.hpp"

#include <unistd.h>

namespace server_sample_file_test {

using namespace aeolis;
using namespace aeolis::server;

namespace {

std::filesystem::path scratch(const std::string& name) {
    return std::filesystem::temp_directory_path() / ("aeolis_tones_" + std::to_string(getpid()) + "_" + name);
}
std::filesystem::path written(const std::string& name, const std::string& text) {
    std::ofstream{scratch(name), std::ios::binary} << text;
    return scratch(name);
}

}  // namespace

TEST_CASE("samples are read back as they were written, in both formats", "[tones]") {
    std::vector<std::complex<float>> samples;
    for (int i = 0; i < 1000; ++i) samples.emplace_back(0.01F * static_cast<float>(i), -0.5F);
    for (const auto& [name, format, scale] :
         {std::tuple{"cf32", SampleFormat::cf32, 1.0F}, std::tuple{"ci16", SampleFormat::ci16, 2896.3F}}) {
        const auto file = scratch(name);
        auto writer = SampleWriter::open(file, format);
        REQUIRE(writer);
        REQUIRE(writer->add(samples));
        REQUIRE(writer->close());
        auto reader = SampleReader::open(file, format);
        REQUIRE(reader);
        CHECK(reader->samples() == 1000);
        std::vector<std::complex<float>> room(300);
        std::size_t at = 0;
        for (auto block = reader->next(room); !block->empty(); block = reader->next(room))
            for (const auto& sample : *block) {
                CHECK(std::abs(sample - scale * samples[at]) <= (scale == 1.0F ? 0.0F : 1.5F));
                ++at;
            }
        CHECK(at == 1000);
        std::filesystem::remove(file);
    }
}

TEST_CASE(
    "a missing or empty sample file and an unknown format are named, and of a truncated one all whole samples are read",
    "[tones]") {
    CHECK(SampleReader::open("/no/such/file", SampleFormat::cf32).error().message.find("/no/such/file") == 0);
    const auto empty = written("empty", "");
    CHECK(SampleReader::open(empty, SampleFormat::cf32).error().message == empty.string() + " is empty");
    const auto cut = written("cut", std::string(19, '\0'));
    auto reader = SampleReader::open(cut, SampleFormat::cf32);
    REQUIRE(reader.ok());
    CHECK(reader->samples() == 2);
    CHECK(reader->left_over_octets() == 3);
    std::vector<std::complex<float>> room(10);
    CHECK(reader->next(room)->size() == 2);
    CHECK(reader->next(room)->empty());
    CHECK(sample_format("wav").error().message.starts_with("there is no sample format 'wav': cf32, "));
    CHECK_FALSE(SampleWriter::open("/no/such/folder/file", SampleFormat::cf32));
    std::filesystem::remove(empty);
    std::filesystem::remove(cut);
}

TEST_CASE("Doppler is read by its column's name, and a fault by its line", "[tones]") {
    const auto sound = written("sound.csv", "# comment\ntime_s,range,doppler_hz_at_8.4GHz\n0,1,-5\r\n1,2,-6\n");
    const auto table = read_doppler(sound);
    REQUIRE(table);
    CHECK(table->at(1.0) == -6.0);
    const auto no_column = written("no_column.csv", "time_s,frequency\n0,1\n");
    CHECK(read_doppler(no_column).error().message.find("no_column.csv:1: there is no column doppler_hz") !=
          std::string::npos);
    const auto no_number = written("no_number.csv", "time_s,doppler_hz\n0,1\n1,x\n");
    CHECK(read_doppler(no_number).error().message.find("no_number.csv:3:") != std::string::npos);
    const auto backward = written("backward.csv", "time_s,doppler_hz\n1,1\n0,1\n");
    CHECK(read_doppler(backward).error().message.find("not later") != std::string::npos);
    CHECK_FALSE(read_doppler("/no/such/file"));
    for (const auto& file : {sound, no_column, no_number, backward}) std::filesystem::remove(file);
}

TEST_CASE("a Doppler that is written is the one that was returned, and near the one that was given", "[tones]") {
    std::vector<double> time_s, doppler_hz;
    for (int i = 0; i <= 40; ++i) {
        time_s.push_back(i);
        doppler_hz.push_back(-450e3 + 1000.0 * std::sin(0.3 * i));
    }
    const TimeTable given = TimeTable::make(time_s, doppler_hz).value();
    const auto file = scratch("written_predict.csv");
    const auto returned = write_doppler(file, given, 5.0, 30.1);
    REQUIRE(returned);
    const auto read = read_doppler(file);
    REQUIRE(read);
    CHECK(read->first_s() == 5.0);
    CHECK(read->last_s() >= 30.1);
    for (double t = 5.0; t < 30.0; t += 0.1) {
        CHECK(read->at(t) == returned->at(t));
        CHECK(read->at(t) == Approx(given.at(t)).margin(1.0));
    }
    CHECK_FALSE(write_doppler(scratch("no_such_folder/x.csv"), given, 0.0, 1.0));
    std::filesystem::remove(file);
}

TEST_CASE("tones to send are in order, whole, and known", "[tones]") {
    const auto sound = written("tones.csv", "start_s,tone\n5,7\n15,255\n");
    const auto tones = read_tones_to_send(sound, 10.0);
    REQUIRE(tones);
    CHECK((*tones)[1].tone == 255);
    const auto overlapping = written("overlapping.csv", "start_s,tone\n5,7\n14,255\n");
    CHECK(read_tones_to_send(overlapping, 10.0).error().message.find("row 2: begins before") != std::string::npos);
    const auto unknown = written("unknown.csv", "start_s,tone\n5,256\n");
    CHECK(read_tones_to_send(unknown, 10.0).error().message.find("there is no tone 256") != std::string::npos);
    for (const auto& file : {sound, overlapping, unknown}) std::filesystem::remove(file);
}

}  // namespace server_sample_file_test
