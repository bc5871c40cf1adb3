#pragma once
/// Raw surface EMG made from a known excitation: amplitude-modulated, band-limited Gaussian noise, and everything that
/// spoils real recordings, each by name and amount. The clean part and the truth are kept apart.
///
/// x(t) = s(e(t)) n(t) + sensor noise + hum + ECG + motion + offset + drift, then clipping, then dropouts.
/// n is unit-variance Gaussian noise of the power spectrum
///     P(f) ~ f_h^4 f^2 / ((f^2 + f_l^2)(f^2 + f_h^2)^2)      (Shwedyk et al. 1977, doi:10.1109/TBME.1977.326175;
///                                                             Stulen & De Luca 1981, doi:10.1109/TBME.1981.324738)
/// limited to [band_low_hz, band_high_hz] (Butterworth, order 2, one pass) and s(e) = amplitude_V e, the amplitude
/// modulation of Hogan & Mann (1980, doi:10.1109/TBME.1980.326652). The ECG is a sum of Gaussians for Q, R, S and T
/// (after McSharry et al. 2003, doi:10.1109/TBME.2003.808805, heights and widths our own), its intervals vary by 3 %.
/// Every disturbance has a random sequence of its own: switching one on does not change the others.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace brachium::emg {

struct SyntheticEmgOptions {
  double rate_hz = 2000.0;          ///< of the EMG
  double amplitude_V = 0.5e-3;      ///< standard deviation of the clean EMG at excitation 1
  double spectrum_low_hz = 60.0;    ///< f_l
  double spectrum_high_hz = 120.0;  ///< f_h
  double band_low_hz = 20.0;        ///< high-pass edge of the electrode and amplifier
  double band_high_hz = 450.0;      ///< low-pass edge; below Nyquist
  std::optional<double>
      snr_db;             ///< power of the clean EMG at excitation 1 over white sensor noise; none: no noise
  double hum_hz = 50.0;   ///< line frequency
  double hum_V = 0.0;     ///< amplitude of the fundamental; harmonic k (odd ones 3, 5, ...) has 1/k of it
  int hum_harmonics = 3;  ///< number of sines, the fundamental among them
  double ecg_V = 0.0;     ///< height of the R wave as it reaches the electrode
  double heart_rate_hz = 1.15;
  double motion_V = 0.0;  ///< standard deviation of motion artefact: noise below 10 Hz
  double offset_V = 0.0;
  double drift_V_per_s = 0.0;
  double clip_V = 0.0;               ///< amplifier range: |x| is limited to it; 0: no limit
  double dropouts_per_minute = 0.0;  ///< expected number; in a dropout the samples are exactly 0
  double dropout_s = 0.05;           ///< length of one
  std::uint64_t seed = 1;            ///< with `stream`, the whole of the randomness
  std::uint64_t stream = 0;          ///< a number for channel and trial, so that all channels are independent
};

struct SyntheticEmg {
  std::vector<double> raw;                 ///< what the recorder stores [V]
  std::vector<double> clean;               ///< s(e) n alone [V]
  std::vector<double> excitation;          ///< the excitation at the EMG's rate
  std::vector<std::size_t> dropout_first;  ///< first sample of each dropout
  std::size_t dropout_samples = 0;         ///< length of each (the last one may be cut by the end)
  std::size_t clipped_samples = 0;
  double mean_rectified_at_unit_V =
      0.0;  ///< E|clean| at excitation 1: amplitude_V sqrt(2/pi), the truth of an MVC
};

/// EMG of an excitation trace (>= 0, at excitation_rate_hz, linear between its samples). Length: the trace's duration
/// at the EMG's rate. Same options, same result; the random numbers are the same on every machine.
/// Throws data::InputError("out-of-range") naming every option outside its domain, ("not-finite") for bad samples.
SyntheticEmg synthesise_emg(std::span<const double> excitation, double excitation_rate_hz,
                            const SyntheticEmgOptions& options);

}  // namespace brachium::emg
