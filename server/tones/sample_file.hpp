// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"
#include "server/tones/recording.hpp"
#include "server/tones/sample_format.hpp"

#include <complex>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <span>
#include <vector>

namespace aeolis::server {

/// Reads samples block by block.
class SampleReader {
  public:
    /// Opens a file. Fails when it does not exist, cannot be read, or is empty.
    static Result<SampleReader> open(const std::filesystem::path& file, SampleFormat format);
    /// Opens the samples of a recording. Its format must be known. Samples that are missing between captures are zeros.
    static Result<SampleReader> open(const SampleRecording& recording);

    /// Reads the next samples, at most room.size(); empty at the end.
    Result<std::span<const std::complex<float>>> next(std::span<std::complex<float>> room);
    /// All, with those that are missing.
    std::uint64_t samples() const { return samples_ + missing_all_; }
    std::uint64_t samples_missing() const { return missing_all_; }
    /// The octets after the last whole sample: the file is truncated or of another format.
    std::uint64_t left_over_octets() const { return left_over_octets_; }
    /// Skips missing samples and a hole of a sparse file (zeros); returns the number of samples skipped.
    std::uint64_t skip_hole();

  private:
    SampleReader(std::filesystem::path file, SampleFormat format) : file_(std::move(file)), format_(format) {}
    std::filesystem::path file_;
    SampleFormat format_;
    std::uint64_t left_over_octets_ = 0;
    std::uint64_t first_octet_ = 0;
    std::uint64_t samples_ = 0, read_ = 0;  ///< stored
    std::vector<MissingSamples> missing_;   ///< those still to come, in order
    std::uint64_t missing_all_ = 0;
    std::ifstream stream_;
    std::vector<char> octets_;
};

/// Writes samples. Integers are scaled so that noise of power 1 a sample has, in each part, a deviation of a sixteenth
/// of their range.
class SampleWriter {
  public:
    static Result<SampleWriter> open(const std::filesystem::path& file, SampleFormat format);
    Result<void> add(std::span<const std::complex<float>> samples);
    Result<void> close();

  private:
    SampleWriter(std::filesystem::path file, SampleFormat format) : file_(std::move(file)), format_(format) {}
    Result<void> state() const;
    std::filesystem::path file_;
    SampleFormat format_;
    std::ofstream stream_;
    std::vector<char> octets_;
};

}  // namespace aeolis::server
