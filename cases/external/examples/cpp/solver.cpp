// A whole material point method: hats, FLIP, stress updated last, neo-Hookean. Usage: solver CASE OUT
// Built against the exported header: c++ -O2 -std=c++17 -I CASE solver.cpp -o solver
#include <array>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "body_force.hpp"

struct Particle { int id; double X[2], x[2], v[2], F[4], m, V0; };

static std::array<double, 4> stress(const double F[4], double lam, double mu)  // xx, yy, zz, xy
{
    const double J = F[0] * F[3] - F[1] * F[2], p = lam * std::log(J) / J, s = mu / J;
    return {s * (F[0] * F[0] + F[1] * F[1] - 1) + p, s * (F[2] * F[2] + F[3] * F[3] - 1) + p, p,
            s * (F[0] * F[2] + F[1] * F[3])};
}

int main(int argc, char **argv)
{
    if (argc != 3) return std::fprintf(stderr, "usage: solver CASE OUT\n"), 2;
    const std::string folder = argv[1], out = argv[2];

    // what the case says
    std::map<std::string, std::string> text;
    std::ifstream flat(folder + "/case.txt");
    for (std::string name, value; flat >> name >> value;) text[name] = value;
    const auto number = [&](const std::string &name) { return std::stod(text.at(name)); };
    const double dx = number("dx"), dt = number("dt"), lam = number("material_lam"), mu = number("material_mu");
    const double lower[2] = {number("grid_lower_x"), number("grid_lower_y")};
    const int nx = int(std::lround((number("grid_upper_x") - lower[0]) / dx)) + 1;
    const int ny = int(std::lround((number("grid_upper_y") - lower[1]) / dx)) + 1;
    const int steps = int(number("steps")), frames = int(number("frames"));

    std::vector<Particle> particles;
    std::ifstream file(folder + "/particles.csv");
    std::string line, cell;
    std::getline(file, line);
    std::map<std::string, int> column;
    std::stringstream head(line);
    for (int k = 0; std::getline(head, cell, ','); ++k) column[cell] = k;
    while (std::getline(file, line)) {
        std::stringstream row(line);
        std::vector<double> r;
        while (std::getline(row, cell, ',')) r.push_back(std::stod(cell));
        const auto at = [&](const char *name) { return r[column.at(name)]; };
        particles.push_back({int(at("id")), {at("X"), at("Y")}, {at("x"), at("y")}, {at("vx_half"), at("vy_half")},
                             {at("Fxx"), at("Fxy"), at("Fyx"), at("Fyy")}, at("m"), at("V0")});
    }

    // walls at rest: which component a node holds
    std::vector<std::array<bool, 2>> held(nx * ny, {false, false});
    const auto wall = [&](const char *side, int axis, int index) {
        const std::string kind = text.at(std::string("edges_") + side);
        for (int k = 0; k < (axis ? nx : ny); ++k) {
            auto &node = held[axis ? k * ny + index : index * ny + k];
            if (kind == "fixed") node = {true, true};
            if (kind == "roller") node[axis] = true;
        }
    };
    wall("left", 0, 0), wall("right", 0, nx - 1), wall("bottom", 1, 0), wall("top", 1, ny - 1);

    int frame = 1;
    for (int step = 1; step <= steps; ++step) {
        std::vector<double> mass(nx * ny, 0.0), momentum(2 * nx * ny, 0.0), force(2 * nx * ny, 0.0);
        const auto each_node = [&](const Particle &p, auto &&visit) {
            const double sx = (p.x[0] - lower[0]) / dx, sy = (p.x[1] - lower[1]) / dx;
            const int i = int(std::floor(sx)), j = int(std::floor(sy));
            if (i < 0 || j < 0 || i + 1 >= nx || j + 1 >= ny) {
                std::fprintf(stderr, "particle %d left the grid at step %d\n", p.id, step);
                std::exit(1);
            }
            for (int a = 0; a < 2; ++a)
                for (int b = 0; b < 2; ++b) {
                    const double Nx = a ? sx - i : 1 - (sx - i), Ny = b ? sy - j : 1 - (sy - j);
                    visit((i + a) * ny + j + b, Nx * Ny, (2 * a - 1) * Ny / dx, (2 * b - 1) * Nx / dx);
                }
        };
        for (const Particle &p : particles) {
            double b[2];
            mms::body_force(p.X, (step - 1) * dt, b);  // at the start of the step
            const auto s = stress(p.F, lam, mu);
            const double V = p.V0 * (p.F[0] * p.F[3] - p.F[1] * p.F[2]);
            each_node(p, [&](int n, double N, double Nx, double Ny) {
                mass[n] += N * p.m;
                for (int a = 0; a < 2; ++a) momentum[2 * n + a] += N * p.m * p.v[a];
                force[2 * n] += N * p.m * b[0] - V * (s[0] * Nx + s[3] * Ny);
                force[2 * n + 1] += N * p.m * b[1] - V * (s[3] * Nx + s[1] * Ny);
            });
        }
        for (int n = 0; n < nx * ny; ++n)  // force becomes acceleration, momentum becomes velocity
            for (int a = 0; a < 2; ++a) {
                const bool moves = mass[n] > 1e-12 * particles[0].m && !held[n][a];
                force[2 * n + a] = moves ? force[2 * n + a] / mass[n] : 0.0;
                momentum[2 * n + a] = moves ? momentum[2 * n + a] / mass[n] + dt * force[2 * n + a] : 0.0;
            }
        for (Particle &p : particles) {
            double L[4] = {0, 0, 0, 0}, move[2] = {0, 0}, push[2] = {0, 0};
            each_node(p, [&](int n, double N, double Nx, double Ny) {
                for (int a = 0; a < 2; ++a) {
                    move[a] += N * momentum[2 * n + a], push[a] += N * force[2 * n + a];
                    L[2 * a] += momentum[2 * n + a] * Nx, L[2 * a + 1] += momentum[2 * n + a] * Ny;
                }
            });
            for (int a = 0; a < 2; ++a) p.v[a] += dt * push[a], p.x[a] += dt * move[a];
            const double F[4] = {p.F[0], p.F[1], p.F[2], p.F[3]};
            for (int a = 0; a < 2; ++a)
                for (int c = 0; c < 2; ++c) p.F[2 * a + c] += dt * (L[2 * a] * F[c] + L[2 * a + 1] * F[2 + c]);
        }
        if (frame <= frames && step == int(number("frames_" + std::to_string(frame)))) {
            std::FILE *result = std::fopen((out + "/result_" + std::to_string(step) + ".csv").c_str(), "w");
            if (!result) return std::perror("result"), 1;
            std::fprintf(result, "id,X,Y,x,y,vx,vy,Fxx,Fxy,Fyx,Fyy,sxx,syy,szz,sxy\n");
            for (const Particle &p : particles) {
                const auto s = stress(p.F, lam, mu);
                std::fprintf(result, "%d,%.17g,%.17g,%.17g,%.17g,%.17g,%.17g,%.17g,%.17g,%.17g,%.17g,%.17g,%.17g,%.17g,%.17g\n",
                             p.id, p.X[0], p.X[1], p.x[0], p.x[1], p.v[0], p.v[1], p.F[0], p.F[1], p.F[2], p.F[3],
                             s[0], s[1], s[2], s[3]);
            }
            std::fclose(result);
            ++frame;
        }
    }
    std::ofstream(out + "/result.json") << R"({"v_lag": 0.5, "F_lag": 0, "b": "start", "version": "toy in C++"})" << "\n";
}
