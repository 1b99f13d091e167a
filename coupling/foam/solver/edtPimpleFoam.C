// pimpleFoam that stays alive: the coupler gives a step's points and takes p and U, as often as it
// likes, before the step is committed. Equations, dictionaries and files are those of the stock
// solver, whose own createFields.H, UEqn.H and pEqn.H are included below.

#include "fvCFD.H"
#include "dynamicFvMesh.H"
#include "singlePhaseTransportModel.H"
#include "turbulentTransportModel.H"
#include "pimpleControl.H"
#include "CorrectPhi.H"
#include "fvOptions.H"
#if OPENFOAM >= 2112
#include "localEulerDdtScheme.H"  // of the stock createFields.H
#endif

#include "coupler.H"
#include "stepTime.H"
#include "slides.H"
#include "sweeps.H"

int main(int argc, char *argv[])
{
    argList::addNote("pimpleFoam on a mesh whose points come from a coupler, step by step.");
    argList::addOption("pipes", "folder", "folder of the pipes request<rank> and answer<rank>");

    #include "addCheckCaseOptions.H"
    #include "setRootCaseLists.H"
    diesWithParent();

    StepTime runTime(Time::controlDictName, args);
    runTime.readLastLength();
    #include "createDynamicFvMesh.H"
    #include "initContinuityErrs.H"
    #include "createDyMControls.H"
    #include "createFields.H"
    #include "createUfIfPresent.H"
    turbulence->validate();

    Coupler coupler(args["pipes"], Pstream::myProcNo());
    coupler.ready(mesh.nCells(), mesh.nPoints(), runTime.value());

    pointField points(mesh.nPoints());
    PtrList<vectorIOField> slides(slidesOf(mesh));

    Request request;
    while (coupler.next(request))
    {
        if (request.command == WRITE)
        {
            runTime.writeNow();
            coupler.answer(request.command, runTime.value());
            continue;
        }
        coupler.read(points, request.count);
        for (vectorIOField& slide : slides) coupler.read(slide);

        if (request.command == ADVANCE)
        {
            runTime.begin(request.start, request.length);
            p.oldTime();
            phi.oldTime();
            U.oldTime().writeOpt() = U.writeOpt();  // a restart after the first step wants them too
            Uf().oldTime().writeOpt() = Uf().writeOpt();
        }
        else  // REPEAT: as the step began; old times, of fields and mesh, are stored once a step
        {
            runTime.repeat(request.start, request.length);
            p == p.oldTime();
            phi == phi.oldTime();
            U == U.oldTime();
            Uf() == Uf().oldTime();
        }
        Info<< "Time = " << runTime.timeName() << nl << endl;

        pairsForwards() = true;
        while (pimple.loop())
        {
            if (pimple.firstIter() || moveMeshOuterCorrectors)
            {
                mesh.movePoints(points);
                U.correctBoundaryConditions();
                MRF.update();
                if (correctPhi)
                {
                    phi = mesh.Sf() & Uf();
                    #include "correctFlux.H"
                    fvc::makeRelative(phi, U);
                }
            }

            #include "UEqn.H"

            while (pimple.correct())
            {
                #include "pEqn.H"
            }

            if (pimple.turbCorr())
            {
                laminarTransport.correct();
                turbulence->correct();
            }
        }
        runTime.printExecutionTime(Info);

        // What the last fluxes miss of the cells' volumes, as the log has it.
        const volScalarField missed(fvc::div(fvc::absolute(phi, U)));
        const scalar continuity =
            runTime.deltaTValue()*mag(missed)().weightedAverage(mesh.V()).value();
        coupler.answer(request.command, runTime.value(), continuity);
        coupler.write(p.primitiveField());
        coupler.write(U.primitiveField());
    }

    Info<< "End\n" << endl;
    return 0;
}
