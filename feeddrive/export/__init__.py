"""A plant in the forms of other tools.

| --to | files | what |
|---|---|---|
| ss | NAME_ss.py | linear model, a module that needs python-control alone |
| mat | NAME.mat | the same for MATLAB, Octave and scipy, with mass, damping and stiffness matrix |
| json | NAME.json | the same, with parameters, modes and notes |
| casadi | NAME.casadi, NAME_casadi.json | nonlinear equations of motion as a CasADi function |
| c | NAME.h, NAME.c, NAME_selftest.c | nonlinear equations and their slopes in C, with a self-test |
| fmu | NAME.fmu | the same as FMI 2.0 for model exchange, with units and sources |

How each is loaded, without feeddrive, for the machine `bench axis`:

    from bench_axis_ss import system                       # ss: a control.StateSpace
    system.poles()

    model = scipy.io.loadmat("bench_axis.mat", simplify_cells=True)          # mat, in Python
    system = control.ss(model["A"], model["B"], model["C"], model["D"])
    % load bench_axis.mat; system = ss(A, B, C, D);                          mat, in MATLAB and Octave

    model = json.load(open("bench_axis.json"))             # json
    model["linear"]["A"], model["modes"]["braked"]["frequencies"]

    f = casadi.Function.load("bench_axis.casadi")          # casadi: what is not given has its default value
    f(x=x0, motor_torque=1.5)["xdot"]

    cc -Wall -ffp-contract=off -o selftest bench_axis.c bench_axis_selftest.c -lm && ./selftest        # c

    fmpy.simulate_fmu("bench_axis.fmu", stop_time=0.1, start_values={"motor_torque": 1.5})             # fmu

SI units everywhere. The linear model holds at its point, by default a moving one: at rest the slope of the friction
swamps everything. The nonlinear forms start at rest unless a velocity is asked for.
"""
