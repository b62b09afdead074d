# tdem in a small image. OpenCL runs on the processor; for CUDA, start it with the container toolkit of NVIDIA, which brings the
# driver, and put libnvrtc of CUDA 12 or 13 on the library path.
#
#   docker build -t tdem .
#   docker run --rm -v "$PWD:/work" tdem run cases/packing.toml
FROM rust:1.95-slim-bookworm AS build
WORKDIR /source
COPY . .
RUN cargo build --release --locked --package tdem

FROM debian:bookworm-slim
RUN apt-get update -qq \
    && apt-get install -y -qq --no-install-recommends ocl-icd-libopencl1 pocl-opencl-icd \
    && rm -rf /var/lib/apt/lists/*
COPY --from=build /source/target/release/tdem /usr/local/bin/tdem
COPY --from=build /source/cases /usr/local/share/tdem/cases
WORKDIR /work
ENTRYPOINT ["tdem"]
CMD ["--help"]
