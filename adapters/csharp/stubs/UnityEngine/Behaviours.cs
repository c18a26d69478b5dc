using System;
using System.Collections.Generic;
using System.Reflection;

namespace UnityEngine
{
    /// <summary>Calls messages by name, as Unity does, even if they are private.</summary>
    public class MonoBehaviour : Behaviour
    {
        private static readonly Dictionary<string, bool> Parameterless = new Dictionary<string, bool>
        {
            { "Awake", true }, { "Start", true }, { "OnEnable", true }, { "OnDisable", true }, { "OnDestroy", true },
            { "Update", true }, { "LateUpdate", true }, { "OnApplicationQuit", true }, { "OnDrawGizmos", true },
            { "OnDrawGizmosSelected", true }, { "OnValidate", true }, { "Reset", true },
        };

        private readonly Dictionary<string, Action> _messages = new Dictionary<string, Action>();
        private bool _awake, _on;

        internal int Order
        {
            get
            {
                object[] found = GetType().GetCustomAttributes(typeof(DefaultExecutionOrder), true);
                return found.Length == 0 ? 0 : ((DefaultExecutionOrder)found[0]).order;
            }
        }

        internal bool On
        {
            get { return _on; }
        }

        internal bool Started { get; set; }

        public void SendMessage(string message)
        {
            Send(message);
        }

        /// <summary>Calls a message if the class has it.</summary>
        internal void Send(string message)
        {
            Action action;
            if (!_messages.TryGetValue(message, out action))
            {
                action = Find(message);
                _messages.Add(message, action);
            }
            if (action != null)
            {
                action();
            }
        }

        internal override void Changed()
        {
            if (!Engine.Playing || Destroyed)
            {
                return;
            }
            if (!_awake && gameObject.activeInHierarchy)
            {
                _awake = true;
                Engine.Add(this);
                Send("Awake");
            }
            if (_awake && _on != isActiveAndEnabled)
            {
                _on = !_on;
                Send(_on ? "OnEnable" : "OnDisable");
            }
        }

        private Action Find(string message)
        {
            const BindingFlags All = BindingFlags.Instance | BindingFlags.Public | BindingFlags.NonPublic | BindingFlags.DeclaredOnly;
            for (Type type = GetType(); type != typeof(MonoBehaviour); type = type.BaseType)
            {
                foreach (MethodInfo method in type.GetMethods(All))
                {
                    if (Parameterless.ContainsKey(method.Name) && method.GetParameters().Length > 0)
                    {
                        throw new InvalidOperationException(type + "." + method.Name + " can not take parameters");
                    }
                    if (method.Name == message)
                    {
                        return (Action)Delegate.CreateDelegate(typeof(Action), this, method);
                    }
                }
            }
            return null;
        }
    }
}
